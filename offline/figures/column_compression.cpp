#include "offline/figures/column_compression.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace greenloop::offline {
namespace {

constexpr std::size_t width = 9;

using Values = std::vector<double>;

double block_norm(const Values& x, std::size_t row) {
  return Eigen::Map<const Eigen::Matrix3d>(x.data() + width * row).norm();
}

double largest_block(const Values& x) {
  double most = 0;
  for (std::size_t row = 0; row < x.size() / width; ++row) most = std::max(most, block_norm(x, row));
  return most;
}

double energy(const Values& x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), x.size()).squaredNorm(); }

}  // namespace

ColumnCompression::ColumnCompression(const SurfaceWavelet& wavelet, const std::vector<double>& thresholds)
    : wavelet_(&wavelet), thresholds_(&thresholds) {
  std::size_t level = 0;
  for (std::size_t row = 0; row < wavelet.rows(); ++row) {
    while (row >= wavelet.row_end(level)) ++level;
    const int coarser = static_cast<int>(level) - static_cast<int>(wavelet.finest());
    level_share_.push_back(level == 0 ? 0 : std::ldexp(1.0, coarser));
  }
}

CompressedColumn ColumnCompression::compress(const Values& column, const TakeError& take) const {
  const std::size_t finest = wavelet_->finest();
  const double peak = largest_block(column);
  Values coefficients = column;
  for (std::size_t level = finest; level > 0; --level) wavelet_->split(level, width, coefficients.data());
  CompressedColumn result{.exact_energy = energy(column), .trials = std::vector<ColumnTrial>(thresholds_->size())};
  for (std::size_t t = 0; t < thresholds_->size(); ++t) {
    ColumnTrial& trial = result.trials[t];
    Values error = dropped(coefficients, (*thresholds_)[t] * peak, trial.kept);
    for (std::size_t level = 1; level <= finest; ++level) wavelet_->merge(level, width, error.data());
    trial.error_energy = energy(error);
    trial.worst = largest_block(error) / peak;
    if (take) take(t, error);
  }
  return result;
}

Values ColumnCompression::dropped(const Values& coefficients, double threshold, std::size_t& kept) const {
  Values drop(coefficients.size(), 0.0);
  for (std::size_t row = 0; row < level_share_.size(); ++row) {
    if (block_norm(coefficients, row) >= level_share_[row] * threshold) {
      ++kept;
    } else {
      std::copy_n(coefficients.begin() + static_cast<std::ptrdiff_t>(width * row), width,
                  drop.begin() + static_cast<std::ptrdiff_t>(width * row));
    }
  }
  return drop;
}

}  // namespace greenloop::offline
