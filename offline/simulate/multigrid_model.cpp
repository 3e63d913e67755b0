#include "offline/simulate/multigrid_model.hpp"

#include <Eigen/Geometry>
#include <stdexcept>
#include <string>

#include "offline/multigrid/hierarchy.hpp"
#include "offline/multigrid/prolongations.hpp"
#include "offline/multigrid/tetrahedron_grid.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "runtime/multigrid/newmark.hpp"

namespace greenloop::offline {
namespace {

/// Numbers of the model's vertices: free ones first.
std::vector<std::uint32_t> model_numbers(const FreeVertices& free) {
  std::vector<std::uint32_t> number;
  auto held = static_cast<std::uint32_t>(free.count);
  for (const int n : free.number) number.push_back(n >= 0 ? static_cast<std::uint32_t>(n) : held++);
  return number;
}

void append(const Eigen::Vector3d& point, std::vector<float>& to) {
  for (const double coordinate : point) to.push_back(static_cast<float>(coordinate));
}

std::vector<layout::MatterRecord> matter_records(const SolidMatter& matter) {
  std::vector<layout::MatterRecord> records;
  for (const SolidMatter::Kind& kind : matter.kinds) {
    const Lame lame(kind.material);
    records.push_back(
        {static_cast<float>(lame.lambda), static_cast<float>(lame.mu), static_cast<float>(kind.density), 0});
  }
  return records;
}

void set_body(const MultigridScene& scene, const std::vector<std::uint32_t>& number, MultigridData& model) {
  const TetrahedralMesh& mesh = scene.mesh;
  std::vector<Eigen::Vector3d> points(mesh.vertices.size());
  for (std::size_t v = 0; v < points.size(); ++v) points[number[v]] = mesh.vertices[v];
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points) {
    append(point, model.points);
    box.extend(point);
  }
  model.info.size = static_cast<float>(box.diagonal().norm());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    layout::TetrahedronRecord record{{}, scene.matter.kind[t]};
    for (std::size_t a = 0; a < 4; ++a) record.vertex[a] = number[mesh.tetrahedra[t][a]];
    model.tetrahedra.push_back(record);
  }
  model.matters = matter_records(scene.matter);
}

void set_shown(const MultigridScene& scene, const std::vector<std::uint32_t>& number, MultigridData& model) {
  const TetrahedronGrid grid(scene.mesh);
  for (const Eigen::Vector3d& point : scene.shown) {
    append(point, model.shown_points);
    const Barycentric place = grid.nearest(point);
    layout::BindingRecord binding{};
    for (std::size_t a = 0; a < 4; ++a) {
      binding.vertex[a] = number[scene.mesh.tetrahedra[place.tetrahedron][a]];
      binding.weight[a] = static_cast<float>(place.coordinate[static_cast<Eigen::Index>(a)]);
    }
    model.bindings.push_back(binding);
  }
  model.shown_triangles = scene.triangles;
}

std::vector<float> floats_of(std::span<const Block<3>> blocks) {
  std::vector<float> floats;
  for (const Block<3>& block : blocks) {
    for (const Float4& column : block.column) floats.insert(floats.end(), {column[0], column[1], column[2], 0.0F});
  }
  return floats;
}

template <class T>
std::vector<T> vector_of(std::span<const T> values) {
  return {values.begin(), values.end()};
}

void set_grids(const Hierarchy& hierarchy, MultigridData& model) {
  for (const MultigridLevel& level : hierarchy.levels()) {
    model.grids.push_back({vector_of(level.start), vector_of(level.upper), vector_of(level.column),
                           floats_of(level.block), floats_of(level.inverse), vector_of(level.parent_start),
                           vector_of(level.parent), vector_of(level.weight)});
  }
  const CoarsestFactor coarsest = hierarchy.coarsest();
  model.coarsest_vertices = coarsest.vertices;
  model.coarsest_factor = vector_of(coarsest.lower);
}

}  // namespace

MultigridData multigrid_model(const MultigridScene& scene) {
  const FreeVertices free(scene.fixed);
  MultigridData model;
  model.info.free = static_cast<std::uint32_t>(free.count);
  model.info.strain = static_cast<std::uint32_t>(scene.strain);
  model.info.time_step = scene.time_step;
  model.info.mass_damping = static_cast<float>(scene.mass_damping);
  model.info.stiffness_damping = static_cast<float>(scene.stiffness_damping);
  model.info.numerical_damping = static_cast<float>(scene.numerical_damping);
  for (Eigen::Index i = 0; i < 3; ++i) model.info.gravity[i] = static_cast<float>(scene.gravity[i]);
  const std::vector<std::uint32_t> number = model_numbers(free);
  set_body(scene, number, model);
  set_shown(scene, number, model);
  const greenloop::Newmark newmark(static_cast<float>(scene.time_step), model.info.numerical_damping,
                                   model.info.mass_damping, model.info.stiffness_damping);
  const BlockMatrix matrix =
      assemble_blocks(scene.mesh, scene.matter, free, static_cast<double>(newmark.stiffness_scale()),
                      static_cast<double>(newmark.mass_scale()));
  const std::vector<double> young = scene.matter.young();
  const Hierarchy hierarchy(matrix, prolongations(scene.mesh, free, young, scene.coarser));
  if (hierarchy.coarsest().vertices > layout::most_coarsest_vertices) {
    throw std::invalid_argument("multigrid: the coarsest grid has " + std::to_string(hierarchy.coarsest().vertices) +
                                " vertices, a model at most " + std::to_string(layout::most_coarsest_vertices) +
                                "; give a coarser mesh more");
  }
  set_grids(hierarchy, model);
  return model;
}

}  // namespace greenloop::offline
