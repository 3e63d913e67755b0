#include "offline/pipeline/build_multigrid_model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <utility>

#include "formats/mesh/coarse_mesh.hpp"
#include "formats/output/json_text.hpp"
#include "formats/output/output_file.hpp"
#include "formats/output/output_paths.hpp"
#include "offline/multigrid/coarsen.hpp"
#include "offline/pipeline/body_geometry.hpp"
#include "offline/scene/toml_source.hpp"
#include "offline/simulate/multigrid_model.hpp"
#include "offline/volume/tetrahedralize.hpp"
#include "runtime/greenloop.h"
#include "runtime/multigrid.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

Eigen::AlignedBox3d box_of(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points) box.extend(point);
  return box;
}

std::vector<std::uint32_t> flat(const std::vector<std::array<int, 3>>& triangles) {
  std::vector<std::uint32_t> corners;
  for (const auto& triangle : triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

/// The last part that a tetrahedron's middle lies in, or the scene's material.
SolidMatter matter_of(const MultigridBody& body, const TetrahedralMesh& mesh) {
  const Eigen::AlignedBox3d box = box_of(mesh.vertices);
  SolidMatter matter;
  matter.kinds.push_back({body.scene.material, body.scene.density.value()});
  for (const MatterPart& part : body.parts) matter.kinds.push_back({part.material, part.density});
  for (const std::array<int, 4>& corners : mesh.tetrahedra) {
    Vector3d middle = Vector3d::Zero();
    for (const int v : corners) middle += 0.25 * mesh.vertices[v];
    const Vector3d at = (middle - box.min()).cwiseQuotient(box.sizes());
    std::uint32_t kind = 0;
    for (std::uint32_t p = 0; p < body.parts.size(); ++p) {
      Eigen::AlignedBox3d part(body.parts[p].box[0]);
      part.extend(body.parts[p].box[1]);
      if (part.contains(at)) kind = p + 1;
    }
    matter.kind.push_back(kind);
  }
  return matter;
}

/// The surface whose inside was filled: its vertices come first.
TriangleMesh boundary(const SemiRegularMesh& surface, int level, const TetrahedralMesh& filled) {
  TriangleMesh mesh{{}, triangles_of_level(surface, level)};
  int last = 0;
  for (const auto& triangle : mesh.triangles) last = std::max({last, triangle[0], triangle[1], triangle[2]});
  mesh.vertices.assign(filled.vertices.begin(), filled.vertices.begin() + last + 1);
  return mesh;
}

MultigridScene loop_scene(const MultigridBody& body, ProgressBar& progress) {
  const BodyGeometry geometry = make_body_geometry(body.scene, progress);
  const int level = std::min(body.level, geometry.surface.finest_level());
  progress.begin("tetrahedra");
  Tetrahedralization filled = tetrahedra_within(geometry, level);
  progress.end(fmt::format("{} tetrahedra, {} vertices, by {}", filled.mesh.tetrahedra.size(),
                           filled.mesh.vertices.size(), filled.mesher));
  progress.begin("grids");
  CoarserMeshes coarser =
      coarsen(boundary(geometry.surface, level, filled.mesh), filled.mesh, static_cast<std::size_t>(body.coarsest));
  progress.end(fmt::format("{} coarser{}", coarser.meshes.size(), coarser.note.empty() ? "" : "; " + coarser.note));
  const auto fixed = evaluate(body.scene.fixed, filled.mesh.vertices, box_of(filled.mesh.vertices));
  MultigridScene scene;
  scene.fixed = {fixed.begin(), fixed.end()};
  scene.matter = matter_of(body, filled.mesh);
  scene.mesh = std::move(filled.mesh);
  scene.coarser = std::move(coarser.meshes);
  scene.strain = static_cast<layout::Strain>(body.strain);
  scene.time_step = body.time_step;
  scene.mass_damping = body.mass_damping;
  scene.stiffness_damping = body.stiffness_damping;
  scene.numerical_damping = body.numerical_damping;
  scene.gravity = body.gravity;
  scene.shown = geometry.surface.positions;
  scene.triangles = flat(triangles_of_level(geometry.surface, geometry.surface.finest_level()));
  return scene;
}

json record_of(const std::filesystem::path& scene_file) {
  return {{"kind", "multigrid"},
          {"scene_text", scene_file_text(scene_file)},
          {"tool", fmt::format("greenloop {}.{}.{}", GREENLOOP_VERSION_MAJOR, GREENLOOP_VERSION_MINOR,
                               GREENLOOP_VERSION_PATCH)}};
}

}  // namespace

json build_multigrid_model(const std::filesystem::path& scene_file, const MultigridBody& body,
                           const std::filesystem::path& model_file, ProgressBar& progress) {
  const auto record_file = std::filesystem::path(model_file).replace_extension(".build.json");
  CommandFiles files{.inputs = {{"the scene", scene_file}}, .outputs = {{"the model", model_file}}};
  if (!is_special(model_file)) files.outputs.push_back({"the record of the build", record_file});
  require_writable(files);
  const MultigridScene scene = loop_scene(body, progress);
  progress.begin("operators");
  MultigridData data = multigrid_model(scene);
  json record = record_of(scene_file);
  data.provenance = json_text(record, -1);
  const ModelFile file = encoded_file(data);
  write_file(model_file, file.bytes.span());
  const Multigrid::Requirement need = Multigrid::required(Model::open(file.bytes.span()).model, {});
  progress.end(fmt::format("{} grids, {} bytes; a step takes at least {} units", data.grids.size() + 1,
                           file.bytes.size(), need.least_work));
  const layout::MultigridInfo& info = *file.view.multigrid.info;
  record.update({{"scene", scene_file.filename().string()},
                 {"bytes", file.bytes.size()},
                 {"tetrahedra", info.tetrahedra},
                 {"vertices", info.vertices},
                 {"free_vertices", info.free},
                 {"grids", info.grids},
                 {"least_work", need.least_work},
                 {"cycle_work", need.cycle_work},
                 {"warnings", progress.warnings()}});
  for (const auto& stage : progress.stages()) {
    record["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  }
  if (!is_special(model_file)) write_text_file(record_file, json_text(record) + "\n");
  return record;
}

}  // namespace greenloop::offline
