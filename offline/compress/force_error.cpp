#include "offline/compress/force_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace greenloop::offline {
namespace {

constexpr std::size_t patch_count = 32, patch_nodes = 16;
constexpr std::size_t width = LiftedLinear::components;

/// Total force that holds every node of `compliance` at the unit displacements: 3 x 3, one column per direction.
Eigen::Matrix3d total_force(const Eigen::MatrixXd& compliance) {
  const Eigen::Index n = compliance.rows() / 3;
  const Eigen::MatrixXd held = Eigen::Matrix3d::Identity().replicate(n, 1);
  const Eigen::MatrixXd force = compliance.partialPivLu().solve(held);
  Eigen::Matrix3d total = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < n; ++i) total += force.middleRows(3 * i, 3);
  return total;
}

std::vector<std::size_t> nearest_columns(const SemiRegularMesh& mesh, const std::vector<std::size_t>& nodes,
                                         std::size_t seed) {
  std::vector<std::pair<double, std::size_t>> distances;
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    distances.emplace_back((mesh.positions[nodes[j]] - mesh.positions[nodes[seed]]).squaredNorm(), j);
  }
  const std::size_t count = std::min(patch_nodes, distances.size());
  std::partial_sort(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(count), distances.end());
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < count; ++i) columns.push_back(distances[i].second);
  std::sort(columns.begin(), columns.end());
  return columns;
}

Eigen::Matrix3d block_at(const std::vector<float>& values, std::size_t row) {
  return Eigen::Map<const Eigen::Matrix3f>(values.data() + width * row).cast<double>();
}

}  // namespace

ContactPatches::ContactPatches(const SemiRegularMesh& mesh, const std::vector<std::size_t>& column_nodes,
                               const LiftedLinear& wavelet)
    : nodes_(column_nodes) {
  const auto& domain = wavelet.nodes();
  for (const std::size_t node : nodes_) {
    rows_.push_back(static_cast<std::size_t>(std::lower_bound(domain.begin(), domain.end(), node) - domain.begin()));
  }
  const std::size_t count = std::min(patch_count, nodes_.size());
  for (std::size_t p = 0; p < count; ++p) {
    Patch patch;
    patch.columns = nearest_columns(mesh, nodes_, p * nodes_.size() / count);
    const auto size = static_cast<Eigen::Index>(3 * patch.columns.size());
    patch.compliance = Eigen::MatrixXd::Zero(size, size);
    patches_.push_back(std::move(patch));
  }
}

void ContactPatches::add(const Eigen::MatrixXd& block, std::size_t first) {
  const auto end = first + static_cast<std::size_t>(block.cols()) / 3;
  for (auto& patch : patches_) {
    for (std::size_t b = 0; b < patch.columns.size(); ++b) {
      const std::size_t column = patch.columns[b];
      if (column < first || column >= end) continue;
      for (std::size_t a = 0; a < patch.columns.size(); ++a) {
        const auto row = static_cast<Eigen::Index>(3 * rows_[patch.columns[a]]);
        patch.compliance.block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)) =
            block.block<3, 3>(row, static_cast<Eigen::Index>(3 * (column - first)));
      }
    }
  }
}

double ContactPatches::worst_force_error(const LiftedLinear& wavelet, const ConstraintLevel& level,
                                         const CompressedLevel& compressed) const {
  const auto& domain = wavelet.nodes();
  double worst = 0;
  for (const auto& patch : patches_) {
    std::vector<std::uint32_t> merged;
    for (const std::size_t column : patch.columns) merged.push_back(level.representatives[nodes_[column]]);
    std::sort(merged.begin(), merged.end());
    merged.erase(std::unique(merged.begin(), merged.end()), merged.end());

    const auto size = static_cast<Eigen::Index>(3 * merged.size());
    Eigen::MatrixXd compliance(size, size);
    for (std::size_t b = 0; b < merged.size(); ++b) {
      const auto values = decode_stored_column(wavelet, compressed.blocks, merged[b]);
      for (std::size_t a = 0; a < merged.size(); ++a) {
        const std::size_t node = level.columns[merged[a]].node;
        const auto row =
            static_cast<std::size_t>(std::lower_bound(domain.begin(), domain.end(), node) - domain.begin());
        compliance.block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)) =
            block_at(values, row);
      }
    }
    const Eigen::Matrix3d exact = total_force(patch.compliance);
    const Eigen::Matrix3d difference = total_force(compliance) - exact;
    for (int direction = 0; direction < 3; ++direction) {
      const double error = difference.col(direction).norm() / exact.col(direction).norm();
      worst = std::isfinite(error) ? std::max(worst, error) : std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

std::vector<float> decode_stored_column(const LiftedLinear& wavelet, const std::vector<BlocksData>& blocks,
                                        std::size_t j) {
  EncodedColumn encoded;
  for (const auto& data : blocks) {
    EncodedColumn::Level level;
    level.scale = data.scale[j];
    for (std::size_t b = data.begin[j]; b < data.begin[j + 1]; ++b) {
      level.rows.push_back(data.dense ? static_cast<std::uint32_t>(b - data.begin[j]) : data.index[b]);
    }
    level.values.assign(data.value.begin() + static_cast<std::ptrdiff_t>(width * data.begin[j]),
                        data.value.begin() + static_cast<std::ptrdiff_t>(width * data.begin[j + 1]));
    encoded.levels.push_back(std::move(level));
  }
  std::vector<float> values;
  decode_column(wavelet, encoded, values);
  return values;
}

}  // namespace greenloop::offline
