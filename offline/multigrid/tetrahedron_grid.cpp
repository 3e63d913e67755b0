#include "offline/multigrid/tetrahedron_grid.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

constexpr int kMostCells = 256;      // along an axis
constexpr double kInside = -1.0e-9;  // the least coordinate of a point that lies on a face

struct Box {
  Eigen::Vector3d low, high;
};

Box box_of(const TetrahedralMesh& mesh, std::size_t t) {
  Box box{mesh.vertices[mesh.tetrahedra[t][0]], mesh.vertices[mesh.tetrahedra[t][0]]};
  for (const int v : mesh.tetrahedra[t]) {
    box.low = box.low.cwiseMin(mesh.vertices[v]);
    box.high = box.high.cwiseMax(mesh.vertices[v]);
  }
  return box;
}

Eigen::Matrix3d edges_of(const TetrahedralMesh& mesh, std::size_t t) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) {
    edges.col(a) = mesh.vertices[mesh.tetrahedra[t][a + 1]] - mesh.vertices[mesh.tetrahedra[t][0]];
  }
  return edges;
}

/// Calls `visit` with every cell from low to high.
template <class Visit>
void each_cell(const Eigen::Vector3i& low, const Eigen::Vector3i& high, const Visit& visit) {
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) visit(Eigen::Vector3i(x, y, z));
    }
  }
}

}  // namespace

TetrahedronGrid::TetrahedronGrid(const TetrahedralMesh& mesh) : mesh_(mesh) {
  if (mesh.tetrahedra.empty()) throw std::invalid_argument("multigrid: a level has no tetrahedra");
  Box all = box_of(mesh, 0);
  double extent = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Eigen::Matrix3d edges = edges_of(mesh, t);
    if (!(edges.determinant() > 0.0)) {
      throw std::invalid_argument("multigrid: tetrahedron " + std::to_string(t) + " of a level has no positive volume");
    }
    inverse_.push_back(edges.inverse());
    const Box box = box_of(mesh, t);
    all.low = all.low.cwiseMin(box.low);
    all.high = all.high.cwiseMax(box.high);
    extent += (box.high - box.low).mean();
  }
  origin_ = all.low;
  size_ = std::max(extent / static_cast<double>(mesh.tetrahedra.size()),
                   (all.high - all.low).maxCoeff() / static_cast<double>(kMostCells - 1));
  cells_ = ((all.high - all.low) / size_).cast<int>() + Eigen::Vector3i::Ones();

  start_.assign(static_cast<std::size_t>(cells_.prod()) + 1, 0);
  const auto each = [&](const auto& visit) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
      const Box box = box_of(mesh, t);
      each_cell(cell_of(box.low), cell_of(box.high), [&](const Eigen::Vector3i& cell) { visit(t, index_of(cell)); });
    }
  };
  each([&](std::size_t, std::size_t cell) { ++start_[cell + 1]; });
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  entry_.resize(start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  each([&](std::size_t t, std::size_t cell) { entry_[next[cell]++] = static_cast<std::uint32_t>(t); });
}

Eigen::Vector3i TetrahedronGrid::cell_of(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d at = ((point - origin_) / size_).array().floor().max(-1.0e6).min(1.0e6);
  return at.cast<int>().cwiseMax(0).cwiseMin(cells_ - Eigen::Vector3i::Ones());
}

std::size_t TetrahedronGrid::index_of(const Eigen::Vector3i& cell) const {
  return static_cast<std::size_t>((cell.z() * cells_.y() + cell.y()) * cells_.x() + cell.x());
}

Eigen::Vector4d TetrahedronGrid::coordinates(std::uint32_t tetrahedron, const Eigen::Vector3d& point) const {
  const Eigen::Vector3d rest = inverse_[tetrahedron] * (point - mesh_.vertices[mesh_.tetrahedra[tetrahedron][0]]);
  return {1.0 - rest.sum(), rest.x(), rest.y(), rest.z()};
}

std::optional<Barycentric> TetrahedronGrid::nearest(const Eigen::Vector3d& point, int rings,
                                                    const Allowed& allowed) const {
  const Eigen::Vector3i middle = cell_of(point);
  std::optional<Barycentric> best;
  const auto consider = [&](const Eigen::Vector3i& cell) {
    for (std::uint32_t i = start_[index_of(cell)]; i < start_[index_of(cell) + 1]; ++i) {
      const std::uint32_t t = entry_[i];
      const Eigen::Vector4d coordinate = coordinates(t, point);
      if (best && coordinate.minCoeff() <= best->least()) continue;
      if (allowed(t)) best = Barycentric{t, coordinate};
    }
  };
  bool found_before = false;
  for (int ring = 0; ring <= rings; ++ring) {
    const Eigen::Vector3i low = (middle.array() - ring).max(0);
    const Eigen::Vector3i high = (middle.array() + ring).min(cells_.array() - 1);
    each_cell(low, high, [&](const Eigen::Vector3i& cell) {
      if ((cell - middle).cwiseAbs().maxCoeff() == ring) consider(cell);
    });
    // what is found may be bettered in the next ring
    if (best && (best->least() >= kInside || found_before)) break;
    found_before = best.has_value();
  }
  return best;
}

Barycentric TetrahedronGrid::nearest(const Eigen::Vector3d& point) const {
  return *nearest(point, kMostCells, [](std::uint32_t) { return true; });
}

std::size_t TetrahedronGrid::region(const Eigen::Vector3d& point) const { return index_of(cell_of(point) / 2); }

}  // namespace greenloop::offline
