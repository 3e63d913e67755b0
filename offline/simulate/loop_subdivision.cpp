#include "offline/simulate/loop_subdivision.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace greenloop::offline {
namespace {

using Edge = std::pair<int, int>;
using Triangles = std::vector<std::array<int, 3>>;
using Weights = std::vector<Eigen::Triplet<double>>;

/// The vertex that splits an edge, and those that complete its triangles.
struct Split {
  int vertex = -1;
  std::vector<int> across;

  [[nodiscard]] bool inside() const { return across.size() == 2; }
};

using Splits = std::map<Edge, Split>;

Edge edge_of(int a, int b) { return std::minmax(a, b); }

Splits splits_of(const Triangles& triangles, int vertices) {
  Splits splits;
  for (const auto& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      Split& split = splits[edge_of(t[i], t[(i + 1) % 3])];
      if (split.vertex < 0) split.vertex = vertices++;
      split.across.push_back(t[(i + 2) % 3]);
    }
  }
  return splits;
}

void add_kept_vertices(const Splits& splits, int vertices, Weights& weights) {
  struct Neighbours {
    std::vector<int> all, along_border;
  };
  std::vector<Neighbours> of(static_cast<std::size_t>(vertices));
  for (const auto& [edge, split] : splits) {
    for (const auto& [a, b] : {edge, Edge{edge.second, edge.first}}) {
      auto& neighbours = of[static_cast<std::size_t>(a)];
      neighbours.all.push_back(b);
      if (!split.inside()) neighbours.along_border.push_back(b);
    }
  }
  for (int v = 0; v < vertices; ++v) {
    const auto& [all, along_border] = of[static_cast<std::size_t>(v)];
    const bool border = !along_border.empty();
    const auto& ring = border ? along_border : all;
    if (ring.empty() || (border && ring.size() != 2)) {  // alone, or a corner of several sheets
      weights.emplace_back(v, v, 1);
      continue;
    }
    const auto n = static_cast<double>(ring.size());
    const double weight = border ? 1.0 / 8 : n == 3 ? 3.0 / 16 : 3.0 / (8 * n);
    weights.emplace_back(v, v, 1 - n * weight);
    for (const int b : ring) weights.emplace_back(v, b, weight);
  }
}

void add_split_edges(const Splits& splits, Weights& weights) {
  for (const auto& [edge, split] : splits) {
    const double ends = split.inside() ? 0.375 : 0.5;
    weights.emplace_back(split.vertex, edge.first, ends);
    weights.emplace_back(split.vertex, edge.second, ends);
    if (!split.inside()) continue;
    for (const int b : split.across) weights.emplace_back(split.vertex, b, 0.125);
  }
}

Triangles split_triangles(const Triangles& triangles, const Splits& splits) {
  Triangles finer;
  for (const auto& [a, b, c] : triangles) {
    const int ab = splits.at(edge_of(a, b)).vertex, bc = splits.at(edge_of(b, c)).vertex,
              ca = splits.at(edge_of(c, a)).vertex;
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return finer;
}

}  // namespace

FinerSheet loop_subdivision(const TriangleMesh& mesh, int levels) {
  auto vertices = static_cast<int>(mesh.vertices.size());
  FinerSheet finer{{vertices, vertices}, mesh.triangles};
  finer.weights.setIdentity();
  for (int level = 0; level < levels; ++level) {
    const Splits splits = splits_of(finer.triangles, vertices);
    Weights entries;
    add_kept_vertices(splits, vertices, entries);
    add_split_edges(splits, entries);
    const int more = vertices + static_cast<int>(splits.size());
    Eigen::SparseMatrix<double, Eigen::RowMajor> step(more, vertices);
    step.setFromTriplets(entries.begin(), entries.end());
    finer.weights = (step * finer.weights).eval();
    finer.triangles = split_triangles(finer.triangles, splits);
    vertices = more;
  }
  return finer;
}

}  // namespace greenloop::offline
