#include "offline/pipeline/scene_loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "offline/sources/fem/green_functions.hpp"
#include "offline/surface/linear_mask.hpp"
#include "offline/volume/tetrahedra_quality.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr int columns_at_once = 64;

layout::LoadRecord load_record(layout::LoadKind kind, const Vector3d& resultant, const std::string& name) {
  layout::LoadRecord record{};
  record.kind = static_cast<std::uint32_t>(kind);
  for (Index k = 0; k < 3; ++k) record.resultant[k] = static_cast<float>(resultant[k]);
  std::copy(name.begin(), name.end(), record.name);
  return record;
}

void add_accelerations(double density, GreenStore& store, LoadDisplacements& loads) {
  const double mass = density * measure_quality(store.contents().volume).volume;
  for (std::uint32_t axis = 0; axis < layout::accelerations; ++axis) {
    const auto kind = static_cast<layout::LoadKind>(axis + 1);
    loads.records.push_back(load_record(kind, mass * Vector3d::Unit(axis), ""));
  }
  loads.displacement.leftCols<3>() = density * body_force_displacement(store);
}

Eigen::AlignedBox3d bounding_box(const std::vector<Vector3d>& positions) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& position : positions) box.extend(position);
  return box;
}

// m^2 of each of a triangle's corners that a pressure acts on: a third of it, or the integrals of a mask
Vector3d pressed_areas(const PressureLoad& load, const std::vector<double>& pressure, const MaskSphere& sphere,
                       const Eigen::Matrix3d& corners, const std::array<int, 3>& triangle) {
  if (load.mask) return mask_integrals(corners, sphere.center, sphere.radius);
  const double least = std::min({pressure[triangle[0]], pressure[triangle[1]], pressure[triangle[2]]});
  const double area = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm() / 2;
  return Vector3d::Constant(least > 0 ? area / 3 : 0);
}

// what a mask puts on nodes that have no column goes to those that have one, in proportion
void keep_to_columns(const std::vector<int>& column_node, std::vector<Vector3d>& forces) {
  std::vector<Vector3d> kept(forces.size(), Vector3d::Zero());
  double all = 0, some = 0;
  for (const Vector3d& force : forces) all += force.norm();
  for (const int node : column_node) {
    kept[node] = forces[node];
    some += forces[node].norm();
  }
  if (some > 0) {
    for (Vector3d& force : kept) force *= all / some;
  }
  forces = std::move(kept);
}

// N per Pa on each surface node
std::vector<Vector3d> pressure_forces(const PressureLoad& load, const TriangleMesh& surface,
                                      const std::vector<int>& column_node) {
  const auto& x = surface.vertices;
  const Eigen::AlignedBox3d box = bounding_box(x);
  const auto pressure = node_pressures(load, x, box);
  const MaskSphere sphere = load.mask ? mask_sphere(std::get<SphereRegion>(load.region), x, box) : MaskSphere{};
  std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
  for (const std::array<int, 3>& triangle : surface.triangles) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = x[triangle[k]];
    const Vector3d area = pressed_areas(load, pressure, sphere, corners, triangle);
    const Vector3d outward = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    const Vector3d along = load.direction ? load.direction->stableNormalized() : Vector3d(-outward.stableNormalized());
    for (int k = 0; k < 3; ++k) forces[triangle[k]] += area(k) * along;
  }
  if (load.mask) keep_to_columns(column_node, forces);
  const auto presses = [](const Vector3d& force) { return force != Vector3d::Zero(); };
  if (std::none_of(forces.begin(), forces.end(), presses)) {
    throw SceneError(
        {"loads: \"" + load.name + "\": no triangle of the surface has its three corners in the region; enlarge it"});
  }
  return forces;
}

void add_pressures(const Scene& scene, const GreenStore& store, LoadDisplacements& loads) {
  const std::vector<int>& nodes = store.contents().column_node;
  const TriangleMesh surface = finest_surface(store.contents().surface);
  const auto count = static_cast<Index>(scene.pressures.size());
  MatrixXd forces(Index{3} * store.column_count(), count);
  for (Index p = 0; p < count; ++p) {
    const auto of_nodes = pressure_forces(scene.pressures[p], surface, nodes);
    Vector3d resultant = Vector3d::Zero();
    for (const Vector3d& force : of_nodes) resultant += force;
    loads.records.push_back(load_record(layout::LoadKind::pressure, resultant, scene.pressures[p].name));
    for (Index c = 0; c < store.column_count(); ++c) {
      forces.col(p).segment<3>(3 * c) = of_nodes[nodes[c]];
    }
  }
  for (int first = 0; first < store.column_count(); first += columns_at_once) {
    const int some = std::min(columns_at_once, store.column_count() - first);
    loads.displacement.rightCols(count) +=
        store.read_columns(first, some) * forces.middleRows(Index{3} * first, Index{3} * some);
  }
}

}  // namespace

LoadDisplacements load_displacements(const Scene& scene, GreenStore& store) {
  const Index accelerations = scene.gravity ? layout::accelerations : 0;
  const auto count = accelerations + static_cast<Index>(scene.pressures.size());
  LoadDisplacements loads{.records = {}, .displacement = MatrixXd::Zero(Index{3} * store.row_count(), count)};
  if (scene.gravity) add_accelerations(scene.density.value(), store, loads);
  if (!scene.pressures.empty()) add_pressures(scene, store, loads);
  return loads;
}

}  // namespace greenloop::offline
