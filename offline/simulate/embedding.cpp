#include "offline/simulate/embedding.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <limits>
#include <stdexcept>

namespace greenloop::offline {
namespace {

struct Cell {
  Eigen::AlignedBox3d box;
  Eigen::Vector3d origin;
  Eigen::Matrix3d inverse;  // from a place to its last three weights

  [[nodiscard]] Eigen::Vector4d weights(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d last = inverse * (point - origin);
    return {1 - last.sum(), last.x(), last.y(), last.z()};
  }
};

std::vector<Cell> cells_of(const TetrahedralMesh& mesh) {
  std::vector<Cell> cells;
  for (const auto& t : mesh.tetrahedra) {
    Cell cell{{}, mesh.vertices[t[0]], {}};
    Eigen::Matrix3d edges;
    for (int a = 0; a < 3; ++a) edges.col(a) = mesh.vertices[t[a + 1]] - cell.origin;
    cell.inverse = edges.inverse();
    for (const int v : t) cell.box.extend(mesh.vertices[v]);
    cells.push_back(cell);
  }
  return cells;
}

/// The cell with the largest smallest weight among those whose boxes come within `reach` of the point; -1: there is
/// none.
int best_cell(const std::vector<Cell>& cells, const Eigen::Vector3d& point, double reach) {
  int best = -1;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (cells[c].box.squaredExteriorDistance(point) > reach * reach) continue;
    const double least = cells[c].weights(point).minCoeff();
    if (least > most) {
      most = least;
      best = static_cast<int>(c);
    }
  }
  return best;
}

}  // namespace

Interpolation embed(const std::vector<Eigen::Vector3d>& points, const TetrahedralMesh& mesh) {
  if (mesh.tetrahedra.empty()) throw std::invalid_argument("embedding: the mesh has no tetrahedra");
  const auto cells = cells_of(mesh);
  const double edge = cells.front().box.diagonal().norm();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t p = 0; p < points.size(); ++p) {
    double reach = 0;
    int cell = best_cell(cells, points[p], reach);
    for (reach = edge / 8; cell < 0; reach *= 2) cell = best_cell(cells, points[p], reach);
    const Eigen::Vector4d weights = cells[cell].weights(points[p]);
    for (int a = 0; a < 4; ++a) {
      entries.emplace_back(static_cast<int>(p), mesh.tetrahedra[cell][a], weights[a]);
    }
  }
  Interpolation result(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(mesh.vertices.size()));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace greenloop::offline
