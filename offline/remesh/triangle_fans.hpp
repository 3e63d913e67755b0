#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace greenloop::offline {

/// The triangles of a closed surface while edges of it collapse, flip and are split. Vertices and triangles keep their
/// numbers; what is gone leaves a gap. Work of each member: linear in the valences of the vertices named.
class TriangleFans {
 public:
  TriangleFans(std::vector<std::array<int, 3>> triangles, std::size_t vertices);

  [[nodiscard]] std::size_t triangles() const { return corners_.size(); }  ///< gone ones included
  [[nodiscard]] bool has_vertex(int v) const { return !around_[v].empty(); }
  [[nodiscard]] bool has_triangle(int t) const { return corners_[t][0] >= 0; }

  [[nodiscard]] const std::array<int, 3>& corners(int t) const { return corners_[t]; }
  [[nodiscard]] const std::vector<int>& around(int v) const { return around_[v]; }
  [[nodiscard]] int valence(int v) const { return static_cast<int>(around_[v].size()); }

  /// In increasing order; of both ends of an edge, in work that the greater valence has no part in.
  [[nodiscard]] std::vector<int> neighbors(int v) const;
  [[nodiscard]] std::vector<int> common_neighbors(int v, int w) const;

  /// The corner after `v` counter-clockwise in triangle t.
  [[nodiscard]] int following(int t, int v) const;

  /// The triangles left and right of the edge from v to w; -1 where there is none. Work: linear in the lesser valence.
  [[nodiscard]] std::array<int, 2> sides(int v, int w) const;

  /// `from` becomes `to`, a neighbour of it; the two triangles at their edge go.
  void collapse(int from, int to);

  /// Exchanges the edge from v to w for the other diagonal of its two triangles.
  void flip(int v, int w);

  /// Puts a vertex, whose number it returns, on the edge from v to w, and splits the two triangles there.
  int split(int v, int w);

 private:
  std::vector<std::array<int, 3>> corners_;  // all -1 of a triangle that is gone
  std::vector<std::vector<int>> around_;     // triangles around each vertex; none once it is gone
};

}  // namespace greenloop::offline
