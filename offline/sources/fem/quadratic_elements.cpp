#include "offline/sources/fem/quadratic_elements.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

constexpr std::array<std::array<int, 2>, 6> edge_corners = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// barycentric coordinates of four points that integrate products of linear functions exactly, a quarter of the volume
// each (Hammer & Stroud 1956)
constexpr double near_corner = 0.58541019662496845446, far_corner = 0.13819660112501051518;

using Gradients = Eigen::Matrix<double, 3, 10>;  // of the four corners' functions, then of the six edges'

struct Element {
  Eigen::Matrix<double, 3, 4> corner;  // gradients of the barycentric coordinates
  double volume = 0;

  Element(const TetrahedralMesh& mesh, const std::array<int, 4>& tetrahedron) {
    Eigen::Matrix3d sides;
    for (int a = 0; a < 3; ++a) {
      sides.row(a) = (mesh.vertices[tetrahedron[a + 1]] - mesh.vertices[tetrahedron[0]]).transpose();
    }
    volume = sides.determinant() / 6.0;
    corner.rightCols<3>() = sides.inverse();
    corner.col(0) = -corner.rightCols<3>().rowwise().sum();
  }

  // gradients at the point beside corner q
  [[nodiscard]] Gradients at(int q) const {
    Gradients gradients;
    gradients.leftCols<4>() = corner;
    for (int e = 0; e < 6; ++e) {
      const auto [a, b] = edge_corners[e];
      const double at_a = a == q ? near_corner : far_corner, at_b = b == q ? near_corner : far_corner;
      gradients.col(4 + e) = 4 * (at_a * corner.col(b) + at_b * corner.col(a));
    }
    return gradients;
  }
};

using ElementStiffness = Eigen::Matrix<double, 30, 30>;  // of the four corners, then of the six edges, by axis

ElementStiffness element_stiffness(const Element& element, double lambda, double mu) {
  ElementStiffness stiffness = ElementStiffness::Zero();
  for (int q = 0; q < 4; ++q) {
    const Gradients gradients = element.at(q);
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b <= a; ++b) {
        const Eigen::Vector3d ga = gradients.col(a), gb = gradients.col(b);
        stiffness.block<3, 3>(3 * a, 3 * b) +=
            0.25 * element.volume *
            (lambda * ga * gb.transpose() + mu * gb * ga.transpose() + mu * ga.dot(gb) * Eigen::Matrix3d::Identity());
      }
    }
  }
  return stiffness.selfadjointView<Eigen::Lower>();
}

void scatter(const ElementStiffness& element, const std::array<int, 10>& number,
             std::vector<Eigen::Triplet<double>>& entries) {
  for (int a = 0; a < 10; ++a) {
    for (int b = 0; b < 10; ++b) {
      const int row = number[a], column = number[b];
      if (row < 0 || column < 0 || row < column) continue;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j <= (row == column ? i : 2); ++j) {
          entries.emplace_back(3 * row + i, 3 * column + j, element(3 * a + i, 3 * b + j));
        }
      }
    }
  }
}

}  // namespace

double QuadraticField::dot(const QuadraticField& other) const {
  return vertex.cwiseProduct(other.vertex).sum() + edge.cwiseProduct(other.edge).sum();
}

void QuadraticField::add(double factor, const QuadraticField& other) {
  vertex += factor * other.vertex;
  edge += factor * other.edge;
}

int MeshEdges::between(int a, int b) const {
  const std::array<int, 2> wanted = {std::min(a, b), std::max(a, b)};
  return static_cast<int>(std::lower_bound(ends.begin(), ends.end(), wanted) - ends.begin());
}

MeshEdges list_edges(const TetrahedralMesh& mesh) {
  MeshEdges edges;
  for (const auto& tetrahedron : mesh.tetrahedra) {
    for (const auto& [i, j] : edge_corners) {
      const int a = tetrahedron[i], b = tetrahedron[j];
      edges.ends.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.ends.begin(), edges.ends.end());
  edges.ends.erase(std::unique(edges.ends.begin(), edges.ends.end()), edges.ends.end());
  for (const auto& tetrahedron : mesh.tetrahedra) {
    auto& of_this = edges.of_tetrahedron.emplace_back();
    for (std::size_t e = 0; e < edge_corners.size(); ++e) {
      of_this[e] = edges.between(tetrahedron[edge_corners[e][0]], tetrahedron[edge_corners[e][1]]);
    }
  }
  return edges;
}

Eigen::SparseMatrix<double> assemble_stiffness(const TetrahedralMesh& mesh, const MeshEdges& edges,
                                               const Material& material, const FreePoints& free) {
  const Lame lame(material);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Element element(mesh, mesh.tetrahedra[t]);
    if (!(element.volume > 0)) {
      throw std::invalid_argument("stiffness: tetrahedron " + std::to_string(t) +
                                  " has no positive volume; repair the tetrahedral mesh");
    }
    std::array<int, 10> number{};
    for (int a = 0; a < 4; ++a) number[a] = free.vertex[mesh.tetrahedra[t][a]];
    for (int e = 0; e < 6; ++e) number[4 + e] = free.edge[edges.of_tetrahedron[t][e]];
    scatter(element_stiffness(element, lame.lambda, lame.mu), number, entries);
  }
  const Eigen::Index unknowns = Eigen::Index{3} * free.count;
  Eigen::SparseMatrix<double> stiffness(unknowns, unknowns);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  return stiffness;
}

QuadraticStiffness::QuadraticStiffness(const TetrahedralMesh& mesh, const MeshEdges& edges, const Material& material)
    : mesh_(mesh), edges_(edges), lame_(material) {}

QuadraticField QuadraticStiffness::zero() const {
  return {Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(mesh_.vertices.size())),
          Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(edges_.ends.size()))};
}

QuadraticField QuadraticStiffness::force(const QuadraticField& displacement) const {
  QuadraticField force = zero();
  for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) {
    const auto& vertices = mesh_.tetrahedra[t];
    const auto& edges = edges_.of_tetrahedron[t];
    const Element element(mesh_, vertices);
    Eigen::Matrix<double, 3, 10> moved, held = Eigen::Matrix<double, 3, 10>::Zero();
    for (int a = 0; a < 4; ++a) moved.col(a) = displacement.vertex.col(vertices[a]);
    for (int e = 0; e < 6; ++e) moved.col(4 + e) = displacement.edge.col(edges[e]);
    for (int q = 0; q < 4; ++q) {
      const Gradients gradients = element.at(q);
      const Eigen::Matrix3d slope = moved * gradients.transpose();
      Eigen::Matrix3d stress = lame_.mu * (slope + slope.transpose());
      stress.diagonal().array() += lame_.lambda * slope.trace();
      held.noalias() += 0.25 * element.volume * stress * gradients;
    }
    for (int a = 0; a < 4; ++a) force.vertex.col(vertices[a]) += held.col(a);
    for (int e = 0; e < 6; ++e) force.edge.col(edges[e]) += held.col(4 + e);
  }
  return force;
}

std::vector<Eigen::Matrix3d> QuadraticStiffness::edge_blocks() const {
  std::vector<Eigen::Matrix3d> blocks(edges_.ends.size(), Eigen::Matrix3d::Zero());
  for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) {
    const Element element(mesh_, mesh_.tetrahedra[t]);
    for (int q = 0; q < 4; ++q) {
      const Gradients gradients = element.at(q);
      for (int e = 0; e < 6; ++e) {
        const Eigen::Vector3d g = gradients.col(4 + e);
        blocks[edges_.of_tetrahedron[t][e]] +=
            0.25 * element.volume *
            ((lame_.lambda + lame_.mu) * g * g.transpose() + lame_.mu * g.squaredNorm() * Eigen::Matrix3d::Identity());
      }
    }
  }
  return blocks;
}

}  // namespace greenloop::offline
