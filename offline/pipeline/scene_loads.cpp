#include "offline/pipeline/scene_loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <string>

#include "offline/sources/fem/green_functions.hpp"
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

// N per Pa on each surface node: a third of what each of its triangles takes
std::vector<Vector3d> pressure_forces(const PressureLoad& load, const TriangleMesh& surface) {
  const auto& x = surface.vertices;
  const auto pressure = node_pressures(load, x, bounding_box(x));
  std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
  bool any = false;
  for (const auto& [a, b, c] : surface.triangles) {
    const double least = std::min({pressure[a], pressure[b], pressure[c]});
    const double most = std::max({pressure[a], pressure[b], pressure[c]});
    if (!((load.mask ? most : least) > 0)) continue;
    any = true;
    const Vector3d outward = (x[b] - x[a]).cross(x[c] - x[a]) / 2;
    const Vector3d force =
        load.direction ? Vector3d(outward.norm() * load.direction->stableNormalized()) : Vector3d(-outward);
    for (const int node : {a, b, c}) forces[node] += pressure[node] / 3 * force;
  }
  if (!any) {
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
    const auto of_nodes = pressure_forces(scene.pressures[p], surface);
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
