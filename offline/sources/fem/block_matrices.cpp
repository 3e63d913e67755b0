#include "offline/sources/fem/block_matrices.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "offline/sources/fem/elasticity.hpp"

namespace greenloop::offline {
namespace {

void check(const TetrahedralMesh& mesh, const SolidMatter& matter, const FreeVertices& free) {
  if (matter.kind.size() != mesh.tetrahedra.size() || free.number.size() != mesh.vertices.size()) {
    throw std::invalid_argument("stiffness: matter of " + std::to_string(matter.kind.size()) + " tetrahedra and " +
                                std::to_string(free.number.size()) + " vertices for a mesh of " +
                                std::to_string(mesh.tetrahedra.size()) + " and " +
                                std::to_string(mesh.vertices.size()));
  }
  for (const SolidMatter::Kind& kind : matter.kinds) {
    require_valid(kind.material);
    if (!(kind.density >= 0.0) || !std::isfinite(kind.density)) {
      throw std::invalid_argument("stiffness: density is " + std::to_string(kind.density) +
                                  " kg/m^3, it must not be negative");
    }
  }
}

/// The numbers of a tetrahedron's free vertices, -1 of fixed ones.
std::array<int, 4> rows_of(const TetrahedralMesh& mesh, std::size_t t, const FreeVertices& free) {
  std::array<int, 4> rows{};
  for (std::size_t a = 0; a < 4; ++a) rows[a] = free.number[mesh.tetrahedra[t][a]];
  return rows;
}

/// A matrix of zeros with a block for each two free vertices of a tetrahedron.
BlockMatrix pattern_of(const TetrahedralMesh& mesh, const FreeVertices& free) {
  std::vector<std::vector<std::uint32_t>> neighbours(static_cast<std::size_t>(free.count));
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const std::array<int, 4> rows = rows_of(mesh, t, free);
    for (const int row : rows) {
      for (const int column : rows) {
        if (row < 0 || column < 0 || row == column) continue;
        auto& list = neighbours[row];
        const auto at = std::lower_bound(list.begin(), list.end(), static_cast<std::uint32_t>(column));
        if (at == list.end() || *at != static_cast<std::uint32_t>(column))
          list.insert(at, static_cast<std::uint32_t>(column));
      }
    }
  }
  BlockMatrix matrix;
  matrix.start.push_back(0);
  for (std::uint32_t v = 0; v < neighbours.size(); ++v) {
    const auto& list = neighbours[v];
    const auto left = std::lower_bound(list.begin(), list.end(), v) - list.begin();
    matrix.upper.push_back(matrix.start.back() + static_cast<std::uint32_t>(left));
    matrix.column.insert(matrix.column.end(), list.begin(), list.end());
    matrix.start.push_back(static_cast<std::uint32_t>(matrix.column.size()));
  }
  matrix.block.resize(matrix.column.size());
  matrix.diagonal.resize(neighbours.size());
  return matrix;
}

DoubleBlock& block_at(BlockMatrix& matrix, int row, int column) {
  if (row == column) return matrix.diagonal[row];
  const auto first = matrix.column.begin() + matrix.start[row], last = matrix.column.begin() + matrix.start[row + 1];
  const auto at = std::lower_bound(first, last, static_cast<std::uint32_t>(column)) - matrix.column.begin();
  return matrix.block[at];
}

struct Element {
  Eigen::Matrix<double, 3, 4> gradient;  // of the barycentric coordinates, 1/m
  double volume;                         // m^3
};

Element element_of(const TetrahedralMesh& mesh, std::size_t t) {
  const auto& corner = mesh.tetrahedra[t];
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) {
    edges.row(a) = (mesh.vertices[corner[a + 1]] - mesh.vertices[corner[0]]).transpose();
  }
  const double determinant = edges.determinant();
  if (!(determinant > 0.0)) {
    throw std::invalid_argument("stiffness: tetrahedron " + std::to_string(t) +
                                " has no positive volume; repair the tetrahedral mesh");
  }
  Element element{{}, determinant / 6.0};
  element.gradient.rightCols<3>() = edges.inverse();
  element.gradient.col(0) = -element.gradient.rightCols<3>().rowwise().sum();
  return element;
}

/// What a tetrahedron's vertices a and b add to the matrix.
Eigen::Matrix3d element_block(const Element& element, const Lame& lame, double stiffness, double mass, int a, int b) {
  const Eigen::Vector3d ga = element.gradient.col(a), gb = element.gradient.col(b);
  Eigen::Matrix3d block =
      stiffness * element.volume * (lame.lambda * ga * gb.transpose() + lame.mu * gb * ga.transpose());
  block.diagonal().array() +=
      stiffness * element.volume * lame.mu * ga.dot(gb) + mass * element.volume * (a == b ? 0.1 : 0.05);
  return block;
}

}  // namespace

std::vector<double> SolidMatter::young() const {
  std::vector<double> result;
  result.reserve(kind.size());
  for (const std::uint32_t k : kind) result.push_back(kinds[k].material.young);
  return result;
}

BlockMatrix assemble_blocks(const TetrahedralMesh& mesh, const SolidMatter& matter, const FreeVertices& free,
                            double stiffness, double mass) {
  check(mesh, matter, free);
  std::vector<Lame> lame;
  for (const SolidMatter::Kind& kind : matter.kinds) lame.emplace_back(kind.material);
  BlockMatrix matrix = pattern_of(mesh, free);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Element element = element_of(mesh, t);
    const std::array<int, 4> rows = rows_of(mesh, t, free);
    const std::uint32_t kind = matter.kind[t];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        if (rows[a] < 0 || rows[b] < 0) continue;
        const Eigen::Matrix3d add =
            element_block(element, lame[kind], stiffness, mass * matter.kinds[kind].density, a, b);
        DoubleBlock& block = block_at(matrix, rows[a], rows[b]);
        for (int j = 0; j < 3; ++j) block.column[j] += Double4{add(0, j), add(1, j), add(2, j), 0.0};
      }
    }
  }
  return matrix;
}

}  // namespace greenloop::offline
