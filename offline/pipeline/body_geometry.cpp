#include "offline/pipeline/body_geometry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/layout.hpp"
#include "formats/mesh/coarse_mesh.hpp"
#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/volume_io.hpp"
#include "offline/compress/wavelet/node_order.hpp"
#include "offline/pipeline/remeshed_skin.hpp"
#include "offline/surface/lumped_areas.hpp"
#include "offline/surface/shells.hpp"
#include "offline/surface/surface_preparation.hpp"
#include "offline/surface/triangle_intersection.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

Eigen::AlignedBox3d bounding_box(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::AlignedBox3d box;
  for (const auto& position : positions) {
    box.extend(position);
  }
  return box;
}

void scale(std::vector<Eigen::Vector3d>& positions, double factor) {
  for (auto& position : positions) {
    position *= factor;
  }
}

/// Runs `work`; what it finds wrong with the scene's mesh is reported with the file's name.
template <class Work>
auto naming_the_file(const Scene& scene, const Work& work) {
  try {
    return work();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(scene.mesh.path.string() + ": " + error.what());
  }
}

TriangleMesh read_skin(const Scene& scene, std::optional<TetrahedralMesh>& volume, MeshNotes& notes) {
  if (!scene.mesh.tetrahedra) return read_surface(scene.mesh.path, notes);
  volume = read_volume(scene.mesh.path, notes);
  return extract_boundary(*volume).surface;
}

/// Runs `work` on the skin of a scene; what it finds wrong is told with `offer`, if a wrap is still to be had.
template <class Work>
auto offering_a_wrap(const Scene& scene, const std::string& offer, const Work& work) {
  try {
    return work();
  } catch (const std::runtime_error& error) {
    if (scene.mesh.wrap) throw;
    const char* const how = scene.mesh.tetrahedra ? ": name the file in [surface] and set wrap = \"auto\""
                                                  : ": set [surface] wrap = \"auto\"";
    throw std::runtime_error(std::string(error.what()) + "\n" + offer + how);
  }
}

// single precision has places to 2^-24 of the largest coordinate
constexpr double most_sizes_from_origin = 1000;

/// Refuses a body whose nodes a model could not tell apart.
void require_near_origin(const Eigen::AlignedBox3d& box) {
  const double size = box.sizes().maxCoeff(), far = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  if (far > most_sizes_from_origin * size) {
    const Eigen::Vector3d center = box.center();
    throw std::runtime_error(fmt::format(
        "the body is {:.3g} m long and lies up to {:.3g} m from the origin, where a model's single precision has "
        "places "
        "{:.2g} m apart; it may be {:.3g} m away: subtract ({:.6g}, {:.6g}, {:.6g}) m from all coordinates",
        size, far, std::ldexp(far, -23), most_sizes_from_origin * size, center.x(), center.y(), center.z()));
  }
}

/// Tetrahedra have the cavities that they have; of a surface they are asked for.
PreparedSurface prepare(const Scene& scene, const TriangleMesh& faces, Weld weld) {
  const bool kept = scene.mesh.tetrahedra || scene.mesh.cavities;
  return prepare_surface(faces, weld, kept ? Inside::cavities : Inside::refused);
}

/// The skin of a scene's mesh in metres, remeshed, and its own tetrahedra. Defects of a surface that is used as it is
/// are reported in the file's own coordinates.
RemeshedSkin read_and_remesh(const Scene& scene, std::optional<TetrahedralMesh>& volume, ProgressBar& progress) {
  MeshNotes notes;
  TriangleMesh faces = naming_the_file(scene, [&] { return read_skin(scene, volume, notes); });
  const double unit = scene.mesh.scale(bounding_box(volume ? volume->vertices : faces.vertices));
  if (volume) scale(volume->vertices, unit);
  if (scene.mesh.wrap) {
    scale(faces.vertices, unit);
    naming_the_file(scene, [&] { require_near_origin(bounding_box(faces.vertices)); });
    return naming_the_file(scene, [&] { return wrap_and_remesh(scene, faces, notes, progress); });
  }
  const Weld weld = scene.mesh.weld ? Weld(*scene.mesh.weld / unit) : std::nullopt;
  return naming_the_file(scene, [&] {
    auto surface =
        offering_a_wrap(scene, "A closed surface can be put around it", [&] { return prepare(scene, faces, weld); });
    surface.repairs.insert(surface.repairs.begin(), notes.begin(), notes.end());
    scale(surface.mesh.vertices, unit);
    for (auto& cavity : surface.cavities) scale(cavity.vertices, unit);
    require_near_origin(bounding_box(surface.mesh.vertices));
    return offering_a_wrap(scene, "An evenly meshed surface around it may do",
                           [&] { return remesh_skin(scene, std::move(surface), progress); });
  });
}

std::vector<std::uint32_t> node_flags(const NodeSets& sets) {
  std::vector<std::uint32_t> flags(sets.fixed.holds.size(), 0);
  for (std::size_t i = 0; i < flags.size(); ++i) {
    flags[i] = (sets.fixed.holds[i] ? layout::node_fixed : 0U) | (sets.touched.holds[i] ? layout::node_touchable : 0U) |
               (sets.read.holds[i] ? layout::node_read : 0U);
  }
  return flags;
}

/// "8 touched (3 + 5 by region)"
std::string role_text(const NodeSet& set, std::string_view role) {
  std::string text = fmt::format("{} {}", set.count(), role);
  return set.of_region.size() < 2 ? text : text + fmt::format(" ({} by region)", fmt::join(set.of_region, " + "));
}

/// A surface node that hangs on fixed vertices of the user's volume only does not move either.
void fix_nodes_without_free_vertices(const Volume& volume, std::vector<std::uint32_t>& flags) {
  for (int node = 0; node < volume.interpolation.outerSize(); ++node) {
    bool free = false;
    for (Interpolation::InnerIterator it(volume.interpolation, node); it; ++it) {
      free = free || (it.value() != 0 && volume.fixed[static_cast<std::size_t>(it.col())] == 0);
    }
    if (!free) {
      flags[static_cast<std::size_t>(node)] = layout::node_fixed;
    }
  }
}

/// How the user's tetrahedra carry the surface: the fixed regions hold their vertices, the nodes lie on their boundary.
Volume attach(const Scene& scene, TetrahedralMesh tetrahedra, const SemiRegularMesh& surface) {
  const auto box = bounding_box(tetrahedra.vertices);
  const auto fixed = evaluate(scene.fixed, tetrahedra.vertices, box);
  constexpr double tolerance = 1e-6;  // of the diagonal: remeshed nodes lie on the boundary up to round-off
  Volume volume{{},
                {fixed.begin(), fixed.end()},
                interpolate_on_boundary(surface.positions, tetrahedra, tolerance * box.diagonal().norm())};
  volume.mesh = std::move(tetrahedra);
  return volume;
}

}  // namespace

BodyGeometry make_body_geometry(const Scene& scene, ProgressBar& progress) {
  BodyGeometry body;

  progress.begin("surface");
  std::optional<TetrahedralMesh> tetrahedra;
  auto [prepared, wrapped, remeshed, walls] = read_and_remesh(scene, tetrahedra, progress);
  body.report = {scene.mesh.name, prepared.report,          prepared.repairs,
                 wrapped,         prepared.cavities.size(), volume_of_all(prepared.cavities),
                 remeshed.quality};
  body.walls = std::move(walls);

  progress.begin("nodes");
  const auto sets = select_nodes(scene, remeshed.mesh.positions, bounding_box(remeshed.mesh.positions));
  progress.end(fmt::format("{}, {}, {}", role_text(sets.fixed, "fixed"), role_text(sets.touched, "touched"),
                           role_text(sets.read, "read")));
  auto flags = node_flags(sets);
  if (tetrahedra) {
    fix_nodes_without_free_vertices(attach(scene, *tetrahedra, remeshed.mesh), flags);
  }
  flags = mark_domain(remeshed.mesh, std::move(flags));
  auto ordered = order_nodes(remeshed.mesh, flags);
  body.flags = ordered.reorder(flags);
  body.surface = std::move(ordered.mesh);
  body.area = lumped_areas(finest_surface(body.surface));
  if (tetrahedra) {
    body.volume = attach(scene, std::move(*tetrahedra), body.surface);
  }
  return body;
}

Tetrahedralization tetrahedra_within(const BodyGeometry& body, int level) {
  const TriangleMesh skin = finest_surface(coarse_mesh(body.surface, level));
  if (body.walls.triangles.empty()) return tetrahedralize(skin);
  const TriangleMesh bounds = joined(skin, body.walls);
  const auto crossing = self_intersections(bounds, std::vector<bool>(bounds.triangles.size(), false));
  if (!crossing.empty()) {
    const Eigen::Vector3d& at = bounds.vertices[bounds.triangles[crossing.front()[0]][0]];
    throw std::runtime_error(
        fmt::format("a cavity's wall meets the surface or another wall at ({:.3g}, {:.3g}, {:.3g}) m, where what is "
                    "between them is thinner than their triangles resolve: raise remesh.levels, or thicken it",
                    at.x(), at.y(), at.z()));
  }
  return tetrahedralize(bounds);
}

FilledVolume fill_with_tetrahedra(const BodyGeometry& body, ProgressBar& progress) {
  progress.begin("tetrahedra");
  auto filled = tetrahedra_within(body, body.surface.finest_level());
  const auto vertices = filled.mesh.vertices.size();
  std::vector<std::uint8_t> fixed(vertices, 0);
  for (std::size_t i = 0; i < body.flags.size(); ++i) {
    fixed[i] = (body.flags[i] & layout::node_fixed) != 0 ? 1 : 0;
  }
  progress.end(fmt::format("{} tetrahedra, {} vertices inside, by {}", filled.mesh.tetrahedra.size(),
                           filled.quality.interior_nodes, filled.mesher));
  return {{std::move(filled.mesh), std::move(fixed),
           select_first_vertices(static_cast<int>(body.flags.size()), static_cast<int>(vertices))},
          std::move(filled.mesher),
          filled.quality};
}

}  // namespace greenloop::offline
