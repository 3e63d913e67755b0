#include "offline/compress/measure/exact_sample.hpp"

#include <algorithm>

namespace greenloop::offline {

std::vector<Eigen::Vector3d> row_positions(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet,
                                           std::size_t level) {
  std::vector<Eigen::Vector3d> result;
  result.reserve(wavelet.row_end(level));
  for (std::size_t row = 0; row < wavelet.row_end(level); ++row) {
    result.push_back(mesh.positions[wavelet.nodes()[row]]);
  }
  return result;
}

std::vector<double> blocks_of(const Eigen::MatrixXd& columns, std::size_t j) {
  std::vector<double> blocks(3 * static_cast<std::size_t>(columns.rows()));
  for (Eigen::Index i = 0; i < columns.rows() / 3; ++i) {
    Eigen::Map<Eigen::Matrix3d>(blocks.data() + 9 * i) = columns.block<3, 3>(3 * i, static_cast<Eigen::Index>(3 * j));
  }
  return blocks;
}

ExactSample::ExactSample(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet, const std::vector<double>& area)
    : patches_(row_positions(mesh, wavelet, wavelet.finest()), most_patches) {
  const std::size_t count = std::min(most_columns, wavelet.rows());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i * wavelet.rows() / count;
    columns_.push_back({.row = row, .area = area[wavelet.nodes()[row]], .exact = {}});
  }
}

void ExactSample::add(const Eigen::MatrixXd& block, std::size_t first) {
  patches_.add(block, first);
  const std::size_t end = first + static_cast<std::size_t>(block.cols()) / 3;
  for (auto& column : columns_) {
    if (column.row >= first && column.row < end) column.exact = blocks_of(block, column.row - first);
  }
}

}  // namespace greenloop::offline
