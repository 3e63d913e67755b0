#include "offline/simulate/examples/subdivision.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace greenloop::offline::examples {
namespace {

using Edge = std::pair<int, int>;

/// What stands across an edge: the vertex that splits it, and the two that complete its triangles.
struct Split {
  int vertex = -1;
  std::array<int, 2> across{-1, -1};
};

Edge edge_of(int a, int b) { return std::minmax(a, b); }

std::map<Edge, Split> splits_of(const TriangleMesh& mesh) {
  std::map<Edge, Split> splits;
  int next = static_cast<int>(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      Split& split = splits[edge_of(t[i], t[(i + 1) % 3])];
      if (split.vertex < 0) split.vertex = next++;
      split.across[split.across[0] < 0 ? 0 : 1] = t[(i + 2) % 3];
    }
  }
  return splits;
}

std::vector<Eigen::Vector3d> kept_vertices(const Cage& cage, const std::map<Edge, Split>& splits) {
  const auto& old = cage.mesh.vertices;
  std::vector<Eigen::Vector3d> sum(old.size(), Eigen::Vector3d::Zero());
  std::vector<int> valence(old.size(), 0);
  for (const auto& [edge, split] : splits) {
    sum[edge.first] += old[edge.second];
    sum[edge.second] += old[edge.first];
    ++valence[edge.first];
    ++valence[edge.second];
  }
  std::vector<Eigen::Vector3d> moved = old;
  for (std::size_t v = 0; v < old.size(); ++v) {
    if (cage.corner[v] != 0) continue;
    const int n = valence[v];
    const double weight = n == 3 ? 3.0 / 16 : 3.0 / (8 * n);
    moved[v] = (1 - n * weight) * old[v] + weight * sum[v];
  }
  return moved;
}

Cage split_once(const Cage& cage) {
  const auto splits = splits_of(cage.mesh);
  const auto& old = cage.mesh.vertices;
  Cage fine{{kept_vertices(cage, splits), {}}, cage.corner};
  fine.mesh.vertices.resize(old.size() + splits.size());
  fine.corner.resize(fine.mesh.vertices.size(), 0);
  for (const auto& [edge, split] : splits) {
    fine.mesh.vertices[split.vertex] =
        0.375 * (old[edge.first] + old[edge.second]) + 0.125 * (old[split.across[0]] + old[split.across[1]]);
  }
  for (const auto& [a, b, c] : cage.mesh.triangles) {
    const int ab = splits.at(edge_of(a, b)).vertex, bc = splits.at(edge_of(b, c)).vertex,
              ca = splits.at(edge_of(c, a)).vertex;
    fine.mesh.triangles.insert(fine.mesh.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

}  // namespace

TriangleMesh subdivide(Cage cage, int levels) {
  for (int i = 0; i < levels; ++i) cage = split_once(cage);
  return std::move(cage.mesh);
}

}  // namespace greenloop::offline::examples
