// The only file that sees OpenVDB. Its templates are instantiated in its library.
#include "offline/wrap/level_set.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace greenloop::offline {
namespace {

using Dense = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;

openvdb::CoordBBox bounds(const Lattice& lattice) {
  return {openvdb::Coord(0, 0, 0), openvdb::Coord(lattice.size[0] - 1, lattice.size[1] - 1, lattice.size[2] - 1)};
}

/// On one thread results do not depend on how work is shared out.
template <class Work>
void on_one_thread(const Work& work) {
  tbb::task_arena arena(1);
  arena.execute(work);
}

}  // namespace

std::vector<float> unsigned_distance(const TriangleMesh& mesh, const Lattice& lattice) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  points.reserve(mesh.vertices.size());
  triangles.reserve(mesh.triangles.size());
  for (const auto& v : mesh.vertices) {
    points.emplace_back(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()));
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.emplace_back(static_cast<openvdb::Index32>(a), static_cast<openvdb::Index32>(b),
                           static_cast<openvdb::Index32>(c));
  }
  std::vector<float> distance(lattice.count());
  on_one_thread([&] {
    const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
    const auto grid =
        openvdb::tools::meshToUnsignedDistanceField<openvdb::FloatGrid>(*unit, points, triangles, {}, band);
    Dense dense(bounds(lattice), distance.data());
    openvdb::tools::copyToDense(*grid, dense);
  });
  for (float& value : distance) value = std::min(value, band);
  return distance;
}

QuadSurface zero_surface(const std::vector<float>& field, const Lattice& lattice) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  on_one_thread([&] {
    openvdb::FloatGrid grid(band);
    const Dense dense(bounds(lattice), const_cast<float*>(field.data()));  // Dense has no view of constants
    openvdb::tools::copyFromDense(dense, grid, 0.0F);
    openvdb::tools::volumeToMesh(grid, points, quads, 0.0);
  });
  QuadSurface surface;
  surface.vertices.reserve(points.size());
  surface.quads.reserve(quads.size());
  for (const auto& p : points) surface.vertices.emplace_back(p.x(), p.y(), p.z());
  for (const auto& q : quads) {
    surface.quads.push_back(
        {static_cast<int>(q[0]), static_cast<int>(q[1]), static_cast<int>(q[2]), static_cast<int>(q[3])});
  }
  return surface;
}

}  // namespace greenloop::offline
