#include "offline/remesh/midpoint_refinement.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop::offline {
namespace {

/// A triangle of some level inside base triangle `base`.
struct RefinedTriangle {
  int base;
  std::array<int, 3> vertices;
  std::array<Eigen::Vector3d, 3> weights;
};

}  // namespace

MidpointRefinement refine_midpoints(const std::vector<std::array<int, 3>>& base_triangles, int base_vertices,
                                    int levels) {
  MidpointRefinement refined;
  refined.mesh.base_triangles = base_triangles;
  refined.mesh.parents.assign(base_vertices, {-1, -1});
  refined.mesh.vertex_end.push_back(base_vertices);
  refined.places.resize(base_vertices);
  std::vector<RefinedTriangle> triangles;
  for (std::size_t t = 0; t < base_triangles.size(); ++t) {
    const int base = static_cast<int>(t);
    triangles.push_back(
        {base, base_triangles[t], {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}});
    for (int c = 0; c < 3; ++c) refined.places[base_triangles[t][c]] = {base, triangles.back().weights[c]};
  }
  for (int level = 1; level <= levels; ++level) {
    std::map<std::pair<int, int>, std::array<int, 2>> midpoints;  // edge -> vertex, times met
    std::vector<RefinedTriangle> finer;
    finer.reserve(4 * triangles.size());
    for (const auto& [base, v, w] : triangles) {
      std::array<int, 3> middle;
      std::array<Eigen::Vector3d, 3> middle_weights;
      for (int e = 0; e < 3; ++e) {
        const auto ends = std::minmax(v[e], v[(e + 1) % 3]);
        middle_weights[e] = (w[e] + w[(e + 1) % 3]) / 2;
        const auto [entry, fresh] = midpoints.try_emplace(ends, std::array{static_cast<int>(refined.places.size()), 0});
        if (++entry->second[1] > 2) {
          throw std::invalid_argument("base mesh: more than one edge joins vertices " + std::to_string(ends.first) +
                                      " and " + std::to_string(ends.second));
        }
        middle[e] = entry->second[0];
        if (!fresh) continue;
        refined.places.push_back({base, middle_weights[e]});
        refined.mesh.parents.push_back({ends.first, ends.second});
      }
      // the order promised by triangles_of_level: three corners, then the middle
      finer.push_back({base, {v[0], middle[0], middle[2]}, {w[0], middle_weights[0], middle_weights[2]}});
      finer.push_back({base, {middle[0], v[1], middle[1]}, {middle_weights[0], w[1], middle_weights[1]}});
      finer.push_back({base, {middle[2], middle[1], v[2]}, {middle_weights[2], middle_weights[1], w[2]}});
      finer.push_back({base, middle, middle_weights});
    }
    refined.mesh.vertex_end.push_back(refined.places.size());
    triangles = std::move(finer);
  }
  refined.mesh.positions.assign(refined.places.size(), Eigen::Vector3d::Zero());
  return refined;
}

SemiRegularMesh truncated(SemiRegularMesh mesh, int levels) {
  mesh.vertex_end.resize(levels + 1);
  mesh.positions.resize(mesh.vertex_end.back());
  mesh.parents.resize(mesh.vertex_end.back());
  return mesh;
}

}  // namespace greenloop::offline
