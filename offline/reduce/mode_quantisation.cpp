#include "offline/reduce/mode_quantisation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "formats/layout.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The value that rounding and the unit leave, within the largest.
std::int16_t whole(double value, double unit, std::int32_t most) {
  if (!(unit > 0)) return 0;
  return static_cast<std::int16_t>(std::clamp<long>(std::lround(value / unit), -most, most));
}

/// What the values of the modes stand for, for coordinates in units of the amplitudes.
Eigen::MatrixXf values_in_metres(const QuantisedModes& quantised, Index rows, Index modes) {
  Eigen::MatrixXf result(rows, modes);
  for (Index v = 0; v < rows; ++v) {
    const float quantum = quantised.quanta[static_cast<std::size_t>(v / layout::block_values)];
    for (Index m = 0; m < modes; ++m) {
      result(v, m) = quantum * static_cast<float>(quantised.values[static_cast<std::size_t>(v * modes + m)]);
    }
  }
  return result;
}

void take_values(const Eigen::MatrixXf& modes, QuantisedModes& quantised) {
  const std::int32_t most = layout::most_value(quantised.planes);
  for (Index begin = 0; begin < modes.rows(); begin += layout::block_values) {
    const Index count = std::min<Index>(layout::block_values, modes.rows() - begin);
    double largest = 0;
    for (Index m = 0; m < modes.cols(); ++m) {
      const double amplitude = quantised.amplitudes[static_cast<std::size_t>(m)];
      largest = std::max(largest, amplitude * modes.col(m).segment(begin, count).cwiseAbs().maxCoeff());
    }
    const auto quantum = static_cast<float>(largest / most);
    quantised.quanta.push_back(quantum);
    for (Index v = begin; v < begin + count; ++v) {
      for (Index m = 0; m < modes.cols(); ++m) {
        const double amplitude = quantised.amplitudes[static_cast<std::size_t>(m)];
        quantised.values.push_back(whole(amplitude * modes(v, m), quantum, most));
      }
    }
  }
}

/// Of displacements of all rows: [U, U'] [q; -c] is the error of a row, and its square needs their Gram matrix only.
double measured_error(const Eigen::MatrixXf& modes, const MatrixXd& rows, const QuantisedModes& quantised) {
  const Index count = modes.cols();
  MatrixXd both(modes.rows(), 2 * count);
  both << modes.cast<double>(), values_in_metres(quantised, modes.rows(), count).cast<double>();
  const MatrixXd gram = both.transpose() * both;
  double sum = 0;
  Eigen::VectorXd difference(2 * count);
  for (Index row = 0; row < rows.cols(); ++row) {
    difference.head(count) = rows.col(row);
    for (Index m = 0; m < count; ++m) {
      difference[count + m] =
          -quantised.coordinates[static_cast<std::size_t>(row * count + m)] / double{layout::most_coordinate};
    }
    sum += std::max(0.0, difference.dot(gram * difference));
  }
  return std::sqrt(sum);
}

}  // namespace

QuantisedModes quantise(const Eigen::MatrixXf& modes, const MatrixXd& rows, std::uint32_t planes) {
  QuantisedModes quantised;
  quantised.planes = planes;
  for (Index m = 0; m < modes.cols(); ++m) {
    quantised.amplitudes.push_back(static_cast<float>(rows.row(m).cwiseAbs().maxCoeff()));
  }
  for (Index row = 0; row < rows.cols(); ++row) {
    for (Index m = 0; m < modes.cols(); ++m) {
      const double unit = quantised.amplitudes[static_cast<std::size_t>(m)] / double{layout::most_coordinate};
      quantised.coordinates.push_back(whole(rows(m, row), unit, layout::most_coordinate));
    }
  }
  take_values(modes, quantised);
  quantised.error = measured_error(modes, rows, quantised);
  return quantised;
}

QuantisedModes quantise_within(const Eigen::MatrixXf& modes, const MatrixXd& rows, double most) {
  QuantisedModes quantised;
  for (std::uint32_t planes = 1; planes <= layout::most_planes; ++planes) {
    quantised = quantise(modes, rows, planes);
    if (quantised.error <= most) return quantised;
  }
  throw std::runtime_error("reduction: 16 bits leave an error of " + std::to_string(quantised.error / most) +
                           " times what accuracy.quantisation allows; raise it");
}

}  // namespace greenloop::offline
