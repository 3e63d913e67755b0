#include "offline/sources/fem/discretization.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "offline/volume/tetrahedra_quality.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Triplet;

struct BoundaryTriangle {
  std::array<int, 3> vertices, edges;  // edge k lies between vertices k and k + 1
  double area;                         // m^2
};

std::vector<BoundaryTriangle> boundary_of(const TetrahedralMesh& mesh, const MeshEdges& edges) {
  std::vector<BoundaryTriangle> boundary;
  for (const auto& [a, b, c] : boundary_triangles(mesh)) {
    const Eigen::Vector3d& x = mesh.vertices[a];
    boundary.push_back({.vertices = {a, b, c},
                        .edges = {edges.between(a, b), edges.between(b, c), edges.between(c, a)},
                        .area = 0.5 * (mesh.vertices[b] - x).cross(mesh.vertices[c] - x).norm()});
  }
  return boundary;
}

// vertices of the volume from its vertices and, after those, its edges
Interpolation vertices_from_points(const TetrahedralMesh& mesh, const MeshEdges& edges) {
  const auto vertices = static_cast<int>(mesh.vertices.size());
  const auto boundary = boundary_of(mesh, edges);
  std::vector<double> weight(mesh.vertices.size(), 0);  // of a vertex's linear function on the boundary
  for (const auto& triangle : boundary) {
    for (const int v : triangle.vertices) weight[v] += triangle.area / 3;
  }
  std::vector<Triplet<double>> entries;
  entries.reserve(mesh.vertices.size() + 9 * boundary.size());
  for (int v = 0; v < vertices; ++v) entries.emplace_back(v, v, 1.0);
  for (const auto& triangle : boundary) {
    for (int k = 0; k < 3; ++k) {
      for (int corner = 0; corner < 3; ++corner) {
        const bool opposite = corner == (k + 2) % 3;
        const int v = triangle.vertices[corner];
        // the integral of the edge's function times the vertex's
        const double integral = triangle.area * (opposite ? 1.0 / 15 : 2.0 / 15);
        entries.emplace_back(v, vertices + triangle.edges[k], integral / weight[v]);
      }
    }
  }
  Interpolation from(vertices, vertices + static_cast<int>(edges.ends.size()));
  from.setFromTriplets(entries.begin(), entries.end());
  return from;
}

double volume_of(const TetrahedralMesh& mesh, const std::array<int, 4>& tetrahedron) {
  const Eigen::Vector3d& x = mesh.vertices[tetrahedron[0]];
  const auto side = [&](int corner) { return Eigen::Vector3d(mesh.vertices[tetrahedron[corner]] - x); };
  return side(1).cross(side(2)).dot(side(3)) / 6;
}

// the columns of free points alone
Interpolation restricted(const Interpolation& all, const FreePoints& free) {
  const auto vertices = static_cast<Eigen::Index>(free.vertex.size());
  std::vector<Triplet<double>> entries;
  for (int row = 0; row < all.outerSize(); ++row) {
    for (Interpolation::InnerIterator it(all, row); it; ++it) {
      const int number = it.col() < vertices ? free.vertex[it.col()] : free.edge[it.col() - vertices];
      if (number >= 0) entries.emplace_back(row, number, it.value());
    }
  }
  Interpolation kept(all.rows(), free.count);
  kept.setFromTriplets(entries.begin(), entries.end());
  return kept;
}

}  // namespace

FreePoints free_points(const FemProblem& problem, const MeshEdges& edges) {
  const FreeVertices vertices(problem.fixed);
  FreePoints free{.vertex = vertices.number, .edge = std::vector<int>(edges.ends.size(), -1), .count = vertices.count};
  if (problem.elements == Elements::linear) return free;
  free.edge.assign(edges.ends.size(), 0);
  for (const auto& triangle : boundary_of(problem.volume, edges)) {
    for (const int edge : triangle.edges) {
      const auto [a, b] = edges.ends[edge];
      if (problem.fixed[a] != 0 && problem.fixed[b] != 0) free.edge[edge] = -1;
    }
  }
  for (int& edge : free.edge) {
    if (edge >= 0) edge = free.count++;
  }
  return free;
}

Eigen::SparseMatrix<double> assemble_stiffness(const FemProblem& problem, const MeshEdges& edges,
                                               const FreePoints& free) {
  return problem.elements == Elements::linear
             ? assemble_stiffness(problem.volume, problem.material, FreeVertices(problem.fixed))
             : assemble_stiffness(problem.volume, edges, problem.material, free);
}

Interpolation nodes_from_points(const FemProblem& problem, const MeshEdges& edges, const FreePoints& free) {
  if (problem.elements == Elements::linear) return restricted(problem.interpolation, free);
  return restricted(problem.interpolation * vertices_from_points(problem.volume, edges), free);
}

Eigen::VectorXd point_volumes(const FemProblem& problem, const MeshEdges& edges, const FreePoints& free) {
  constexpr double vertex_share = 1.0 / 4, edge_share = 1.0 / 5;  // of L_a, of 4 L_a L_b
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(free.count);
  const auto add = [&](int number, double volume) {
    if (number >= 0) volumes[number] += volume;
  };
  for (std::size_t t = 0; t < problem.volume.tetrahedra.size(); ++t) {
    const double volume = volume_of(problem.volume, problem.volume.tetrahedra[t]);
    for (const int v : problem.volume.tetrahedra[t]) add(free.vertex[v], vertex_share * volume);
    for (const int e : edges.of_tetrahedron[t]) add(free.edge[e], edge_share * volume);
  }
  return volumes;
}

}  // namespace greenloop::offline
