#include "offline/compress/hierarchy.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

using Hats = std::vector<std::vector<HatWeight>>;

void accumulate(std::vector<HatWeight>& sum, const std::vector<HatWeight>& part, double factor) {
  for (const auto& [vertex, weight] : part) {
    const auto it = std::find_if(sum.begin(), sum.end(), [&, v = vertex](const auto& s) { return s.vertex == v; });
    if (it == sum.end()) {
      sum.push_back({vertex, factor * weight});
    } else {
      it->weight += factor * weight;
    }
  }
}

/// Per node the hats of K(level) that reach it: at most three, which sum to one.
Hats hats_at_nodes(const SemiRegularMesh& mesh, std::uint32_t level) {
  Hats hats(mesh.positions.size());
  for (std::size_t node = 0; node < hats.size(); ++node) {
    if (node < mesh.vertex_end[level]) {
      hats[node] = {{node, 1.0}};
    } else {
      for (const int parent : mesh.parents[node]) accumulate(hats[node], hats[static_cast<std::size_t>(parent)], 0.5);
    }
    std::sort(hats[node].begin(), hats[node].end(), [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
  }
  return hats;
}

void require_increasing(const std::vector<std::size_t>& nodes, std::size_t count) {
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    if (nodes[j] >= count || (j > 0 && nodes[j] <= nodes[j - 1])) {
      throw std::invalid_argument("compression: column_nodes[" + std::to_string(j) + "] is " +
                                  std::to_string(nodes[j]) + "; column nodes must increase and be below " +
                                  std::to_string(count));
    }
  }
}

std::uint32_t nearest_column(const SemiRegularMesh& mesh, const std::vector<layout::ColumnRecord>& columns,
                             std::size_t node) {
  std::uint32_t nearest = layout::none;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < columns.size(); ++k) {
    const double distance = (mesh.positions[columns[k].node] - mesh.positions[node]).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = k;
    }
  }
  return nearest;
}

/// The vertices of K(level) one edge away from each.
std::vector<std::vector<std::size_t>> neighbours(const SemiRegularMesh& mesh, std::uint32_t level) {
  std::vector<std::vector<std::size_t>> ring(mesh.vertex_end[level]);
  for (const auto& triangle : triangles_of_level(mesh, static_cast<int>(level))) {
    for (int corner = 0; corner < 3; ++corner) {
      // the surface is closed: the other direction of the edge belongs to the next triangle
      ring[static_cast<std::size_t>(triangle[corner])].push_back(static_cast<std::size_t>(triangle[(corner + 1) % 3]));
    }
  }
  return ring;
}

/// `nodes` and all their ancestors, increasing.
std::vector<std::size_t> with_ancestors(const SemiRegularMesh& mesh, std::vector<std::size_t> nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const int parent : mesh.parents[nodes[i]]) {
      if (parent >= 0 && std::find(nodes.begin(), nodes.end(), static_cast<std::size_t>(parent)) == nodes.end()) {
        nodes.push_back(static_cast<std::size_t>(parent));
      }
    }
  }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

std::uint32_t representative(const SemiRegularMesh& mesh, const ConstraintLevel& level,
                             const std::vector<HatWeight>& shares, std::size_t node) {
  const HatWeight* best = nullptr;
  for (const auto& share : shares) {
    if (best == nullptr || share.weight > best->weight) best = &share;
  }
  return best != nullptr ? static_cast<std::uint32_t>(best->vertex) : nearest_column(mesh, level.columns, node);
}

}  // namespace

ConstraintLevel constraint_level(const SemiRegularMesh& mesh, const std::vector<double>& area,
                                 const std::vector<std::size_t>& column_nodes, std::uint32_t level) {
  require_increasing(column_nodes, mesh.positions.size());
  ConstraintLevel result;
  result.level = level;
  std::vector<std::uint32_t> column_of(mesh.vertex_end[level], layout::none);
  for (const std::size_t node : column_nodes) {
    if (node >= mesh.vertex_end[level]) break;
    column_of[node] = static_cast<std::uint32_t>(result.columns.size());
    result.columns.push_back({static_cast<std::uint32_t>(node), 0.0F});
  }

  const auto ring = neighbours(mesh, level);
  for (const auto& column : result.columns) {
    auto near = ring[column.node];
    near.push_back(column.node);
    result.near.push_back(with_ancestors(mesh, std::move(near)));
  }

  const Hats hats = hats_at_nodes(mesh, level);
  std::vector<double> total(result.columns.size(), 0.0);
  result.representatives.assign(mesh.positions.size(), layout::none);
  for (const std::size_t node : column_nodes) {
    std::vector<HatWeight> shares;
    for (const auto& [vertex, weight] : hats[node]) {
      if (column_of[vertex] != layout::none) shares.push_back({column_of[vertex], weight});
    }
    if (!result.columns.empty()) result.representatives[node] = representative(mesh, result, shares, node);
    for (auto& share : shares) {
      share.weight *= area[node];
      total[share.vertex] += share.weight;
    }
    result.share.push_back(std::move(shares));
  }
  for (auto& shares : result.share) {
    for (auto& share : shares) share.weight /= total[share.vertex];
  }
  for (std::size_t k = 0; k < total.size(); ++k) result.columns[k].area = static_cast<float>(total[k]);
  return result;
}

CoarseColumns::CoarseColumns(const ConstraintLevel& level, std::size_t rows)
    : level_(&level),
      columns_(Eigen::MatrixXf::Zero(static_cast<Eigen::Index>(3 * rows),
                                     static_cast<Eigen::Index>(3 * level.columns.size()))) {}

void CoarseColumns::add(const Eigen::MatrixXd& block, std::size_t first) {
  const Eigen::Index count = block.cols() / 3;
  Eigen::MatrixXf exact;
  for (Eigen::Index j = 0; j < count; ++j) {
    exact = block.middleCols(3 * j, 3).cast<float>();
    for (const auto& [column, weight] : level_->share[first + static_cast<std::size_t>(j)]) {
      columns_.middleCols(3 * static_cast<Eigen::Index>(column), 3) += static_cast<float>(weight) * exact;
    }
  }
}

ColumnSource CoarseColumns::source() const {
  return [this](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
    return columns_.middleCols(3 * static_cast<Eigen::Index>(first), 3 * static_cast<Eigen::Index>(count))
        .cast<double>();
  };
}

}  // namespace greenloop::offline
