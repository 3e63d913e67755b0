#include "offline/appearance/transfer_basis.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

constexpr Index numbers_of_colour = layout::light_coefficients;
constexpr Index numbers_of_vertex = layout::colours * numbers_of_colour;
constexpr std::int32_t most_of_mean = 256 * 127 + 127, most_of_mode = 127;

/// Where number i (of 16) of a part (two planes of the mean, then modes) stands in a block and colour.
std::size_t place_of(Index part, Index vertex_in_block, Index i) {
  const Index pair = numbers_of_colour / 2 * part + i / 2;
  return static_cast<std::size_t>((pair * layout::block_vertices + vertex_in_block) * 2 + i % 2);
}

/// Writes numbers of a basis into blocks and reads them back.
class TransferBlocks {
 public:
  TransferBlocks(Index vertices, Index modes, AppearanceData& data)
      : vertices_(vertices),
        modes_(modes),
        data_(data),
        bytes_(layout::transfer_bytes(static_cast<std::uint32_t>(modes))) {
    const auto blocks = static_cast<std::size_t>((vertices + layout::block_vertices - 1) / layout::block_vertices);
    data.transfers.assign(blocks * layout::colours * bytes_, 0);
    data.quanta.assign(2 * blocks, 0);
  }

  /// mean: [48 vertices]; modes: [48 vertices][modes], for coordinates of 1 at most. Their errors, [1 + modes] columns.
  MatrixXf write(const Eigen::VectorXf& mean, const MatrixXf& modes) {
    MatrixXf errors(mean.size(), 1 + modes_);
    for (Index begin = 0; begin < vertices_; begin += layout::block_vertices) {
      const Index count = numbers_of_vertex * std::min<Index>(layout::block_vertices, vertices_ - begin);
      const Index first = numbers_of_vertex * begin;
      const auto block = static_cast<std::size_t>(begin / layout::block_vertices);
      float* const quantum = &data_.quanta[2 * block];
      quantum[0] = mean.segment(first, count).cwiseAbs().maxCoeff() / static_cast<float>(most_of_mean);
      quantum[1] = modes.middleRows(first, count).cwiseAbs().maxCoeff() / static_cast<float>(most_of_mode);
      for (Index n = first; n < first + count; ++n) {
        errors(n, 0) = mean[n] - write_mean(block, n - first, mean[n], quantum[0]);
        for (Index m = 0; m < modes_; ++m)
          errors(n, 1 + m) = modes(n, m) - write_mode(block, n - first, m, modes(n, m), quantum[1]);
      }
    }
    return errors;
  }

 private:
  static std::int32_t whole(float value, float quantum, std::int32_t most) {
    if (!(quantum > 0)) return 0;
    return static_cast<std::int32_t>(std::clamp<long>(std::lround(value / quantum), -most, most));
  }

  std::int8_t& at(std::size_t block, Index number, Index part) {
    const Index vertex = number / numbers_of_vertex, colour = number % numbers_of_vertex / numbers_of_colour;
    const std::size_t first = (block * layout::colours + static_cast<std::size_t>(colour)) * bytes_;
    return data_.transfers[first + place_of(part, vertex, number % numbers_of_colour)];
  }

  float write_mean(std::size_t block, Index number, float value, float quantum) {
    const std::int32_t rounded = whole(value, quantum, most_of_mean), low = ((rounded + 128) & 255) - 128;
    at(block, number, 0) = static_cast<std::int8_t>((rounded - low) / 256);
    at(block, number, 1) = static_cast<std::int8_t>(low);
    return static_cast<float>(rounded) * quantum;
  }

  float write_mode(std::size_t block, Index number, Index mode, float value, float quantum) {
    const std::int32_t rounded = whole(value, quantum, most_of_mode);
    at(block, number, 2 + mode) = static_cast<std::int8_t>(rounded);
    return static_cast<float>(rounded) * quantum;
  }

  Index vertices_, modes_;
  AppearanceData& data_;
  std::size_t bytes_;
};

}  // namespace

double TransferBasis::truncation(Index rank) const {
  const auto square = [](double sum, double value) { return sum + value * value; };
  const auto first = singular_values.begin() + std::min<std::ptrdiff_t>(rank, std::ssize(singular_values));
  return std::sqrt(std::accumulate(first, singular_values.end(), 0.0, square) /
                   std::accumulate(singular_values.begin(), singular_values.end(), 0.0, square));
}

TransferBasis transfer_basis(const std::vector<const Eigen::VectorXf*>& transfers, Index rank, double error) {
  const auto count = static_cast<Index>(transfers.size());
  TransferBasis basis;
  basis.mean = Eigen::VectorXf::Zero(transfers.front()->size());
  for (const auto* transfer : transfers) basis.mean += *transfer / static_cast<float>(count);
  MatrixXd gram = MatrixXd::Zero(count, count);
  constexpr Index slice = 1 << 14;  // so that few differences are in memory at once
  MatrixXd differences(slice, count);
  for (Index begin = 0; begin < basis.mean.size(); begin += slice) {
    const Index size = std::min(slice, basis.mean.size() - begin);
    for (Index k = 0; k < count; ++k) {
      differences.col(k).head(size) =
          (transfers[static_cast<std::size_t>(k)]->segment(begin, size) - basis.mean.segment(begin, size))
              .cast<double>();
    }
    gram += differences.topRows(size).transpose() * differences.topRows(size);
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(gram);
  for (Index k = count - 1; k >= 0; --k)
    basis.singular_values.push_back(std::sqrt(std::max(0.0, solver.eigenvalues()[k])));
  constexpr double rounding = 1e-6;  // of single precision, in the mean
  if (!(basis.singular_values.front() > rounding * static_cast<double>(basis.mean.norm())))
    throw std::runtime_error("appearance: light falls on all states alike; leave [appearance] out");
  Index modes = 1;
  const Index most = std::min(rank, count - 1);
  while (modes < most && basis.truncation(modes) > error) ++modes;
  basis.modes = MatrixXf::Zero(basis.mean.size(), modes);
  basis.coordinates.resize(modes, count);
  for (Index m = 0; m < modes; ++m) {
    const VectorXd vector = solver.eigenvectors().col(count - 1 - m);
    const double value = basis.singular_values[static_cast<std::size_t>(m)];
    for (Index k = 0; k < count; ++k) {
      basis.modes.col(m) +=
          static_cast<float>(vector[k] / value) * (*transfers[static_cast<std::size_t>(k)] - basis.mean);
    }
    basis.coordinates.row(m) = value * vector.transpose();
  }
  return basis;
}

AppearanceData quantised(const TransferBasis& basis, const MatrixXd& rows) {
  const Index modes = basis.modes.cols();
  AppearanceData data;
  VectorXd amplitude = rows.cwiseAbs().rowwise().maxCoeff();
  for (Index m = 0; m < modes; ++m)
    data.amplitudes.push_back({static_cast<float>(amplitude[m]), static_cast<float>(basis.truncation(m + 1))});
  for (Index row = 0; row < rows.cols(); ++row) {
    for (Index m = 0; m < modes; ++m) {
      const double at = amplitude[m] > 0 ? rows(m, row) / amplitude[m] : 0;
      data.coordinates.push_back(static_cast<std::int16_t>(std::lround(at * layout::most_coordinate)));
    }
  }
  const MatrixXf scaled = basis.modes * amplitude.cast<float>().asDiagonal();
  const MatrixXf errors = TransferBlocks(basis.mean.size() / numbers_of_vertex, modes, data).write(basis.mean, scaled);
  const MatrixXd gram = (errors.transpose() * errors).cast<double>();
  double sum = 0;
  VectorXd coordinates(1 + modes);
  for (Index row = 0; row < rows.cols(); ++row) {
    coordinates[0] = 1;
    for (Index m = 0; m < modes; ++m) coordinates[1 + m] = amplitude[m] > 0 ? rows(m, row) / amplitude[m] : 0;
    sum += std::max(0.0, coordinates.dot(gram * coordinates));
  }
  data.quantisation_error = static_cast<float>(std::sqrt(sum / rows.squaredNorm()));
  return data;
}

}  // namespace greenloop::offline
