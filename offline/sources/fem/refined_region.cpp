#include "offline/sources/fem/refined_region.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector4d;

// points of a split tetrahedron: its corners 0..3, then the middles of its edges 01 02 03 12 13 23
constexpr std::array<std::array<int, 2>, 10> ends_of = {
    {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
constexpr std::array<std::array<int, 4>, 4> corner_parts = {{{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}}};

// an octahedron remains: a diagonal of it, and the ring of the others
struct Octahedron {
  int from, to;
  std::array<int, 4> ring;
};
constexpr std::array<Octahedron, 3> octahedra = {{{4, 9, {5, 7, 8, 6}}, {5, 8, {4, 7, 9, 6}}, {6, 7, {4, 8, 9, 5}}}};

Vector4d barycentric(int point) {
  const auto [a, b] = ends_of[point];
  return 0.5 * (Vector4d::Unit(a) + Vector4d::Unit(b));
}

class Refinement {
 public:
  Refinement(const TetrahedralMesh& mesh, const MeshEdges& edges, const Held& held, const QuadraticField& displacement,
             std::span<const int> tetrahedra)
      : mesh_(mesh), edges_(edges), displacement_(displacement), known_(held) {
    std::vector<std::uint8_t> inside(mesh.tetrahedra.size(), 0);
    for (const int t : tetrahedra) inside[t] = 1;
    for (std::size_t t = 0; t < inside.size(); ++t) {
      if (inside[t] == 0) hold_all_of(t);
    }
    point_of_vertex_.assign(mesh.vertices.size(), -1);
    point_of_edge_.assign(edges.ends.size(), -1);
    for (const int t : tetrahedra) split(t);
    region_.edges = list_edges(region_.mesh);
    take_displacement(tetrahedra);
  }

  RefinedRegion take() && { return std::move(region_); }

 private:
  void hold_all_of(std::size_t t) {
    for (const int v : mesh_.tetrahedra[t]) known_.vertices[v] = 1;
    for (const int e : edges_.of_tetrahedron[t]) known_.edges[e] = 1;
  }

  // the number of a vertex or of the middle of an edge among the region's vertices
  int number(int& point, const Vector3d& place, const Vector3d& moved, std::uint8_t held) {
    if (point < 0) {
      point = static_cast<int>(region_.mesh.vertices.size());
      region_.mesh.vertices.push_back(place);
      moved_.push_back(moved);
      region_.held.vertices.push_back(held);
    }
    return point;
  }

  std::array<int, 10> points_of(int t) {
    std::array<int, 10> points{};
    for (int a = 0; a < 4; ++a) {
      const int v = mesh_.tetrahedra[t][a];
      points[a] = number(point_of_vertex_[v], mesh_.vertices[v], displacement_.vertex.col(v), known_.vertices[v]);
    }
    for (int k = 0; k < 6; ++k) {
      const int e = edges_.of_tetrahedron[t][k];
      const auto [a, b] = edges_.ends[e];
      const Vector3d moved =
          0.5 * (displacement_.vertex.col(a) + displacement_.vertex.col(b)) + displacement_.edge.col(e);
      points[4 + k] = number(point_of_edge_[e], 0.5 * (mesh_.vertices[a] + mesh_.vertices[b]), moved, known_.edges[e]);
    }
    return points;
  }

  void split(int t) {
    const std::array<int, 10> points = points_of(t);
    const auto length = [&](const Octahedron& o) {
      return (region_.mesh.vertices[points[o.from]] - region_.mesh.vertices[points[o.to]]).squaredNorm();
    };
    const Octahedron& octahedron = *std::min_element(
        octahedra.begin(), octahedra.end(), [&](const auto& a, const auto& b) { return length(a) < length(b); });
    for (const auto& part : corner_parts) add(points, part);
    for (int k = 0; k < 4; ++k) {
      add(points, {octahedron.from, octahedron.to, octahedron.ring[k], octahedron.ring[(k + 1) % 4]});
    }
  }

  void add(const std::array<int, 10>& points, std::array<int, 4> part) {
    const auto side = [&](int k) -> Vector3d {
      return region_.mesh.vertices[points[part[k]]] - region_.mesh.vertices[points[part[0]]];
    };
    if (side(1).cross(side(2)).dot(side(3)) < 0) std::swap(part[2], part[3]);
    region_.mesh.tetrahedra.push_back({points[part[0]], points[part[1]], points[part[2]], points[part[3]]});
    parts_.push_back(part);
  }

  void take_displacement(std::span<const int> tetrahedra) {
    region_.displacement.vertex.resize(3, static_cast<Index>(moved_.size()));
    for (std::size_t v = 0; v < moved_.size(); ++v) region_.displacement.vertex.col(static_cast<Index>(v)) = moved_[v];
    region_.displacement.edge.resize(3, static_cast<Index>(region_.edges.ends.size()));
    region_.held.edges.resize(region_.edges.ends.size());
    constexpr std::array<std::array<int, 2>, 6> corners = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      const int t = tetrahedra[part / 8];
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const int e = region_.edges.of_tetrahedron[part][k];
        const Vector4d from = barycentric(parts_[part][corners[k][0]]), to = barycentric(parts_[part][corners[k][1]]);
        region_.displacement.edge.col(e) = bulge(t, to - from);
        region_.held.edges[e] = is_known(t, to + from) ? 1 : 0;
      }
    }
  }

  // what a quadratic function has in the middle of a line beside its ends: with 4 L_a L_b, minus the product of their
  // differences
  [[nodiscard]] Vector3d bulge(int t, const Vector4d& along) const {
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = ends_of[4 + k];
      sum -= along[a] * along[b] * displacement_.edge.col(edges_.of_tetrahedron[t][k]);
    }
    return sum;
  }

  // an edge of a part is known if all edges are whose ends it lies between
  [[nodiscard]] bool is_known(int t, const Vector4d& between) const {
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = ends_of[4 + k];
      if (between[a] != 0 && between[b] != 0 && known_.edges[edges_.of_tetrahedron[t][k]] == 0) return false;
    }
    return true;
  }

  const TetrahedralMesh& mesh_;
  const MeshEdges& edges_;
  const QuadraticField& displacement_;
  Held known_;  // also what tetrahedra outside share
  std::vector<int> point_of_vertex_, point_of_edge_;
  std::vector<Vector3d> moved_;
  std::vector<std::array<int, 4>> parts_;  // of each part the points that are its corners
  RefinedRegion region_;
};

}  // namespace

RefinedRegion refine_region(const TetrahedralMesh& mesh, const MeshEdges& edges, const Held& held,
                            const QuadraticField& displacement, std::span<const int> tetrahedra) {
  return Refinement(mesh, edges, held, displacement, tetrahedra).take();
}

}  // namespace greenloop::offline
