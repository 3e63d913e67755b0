#include "offline/compress/column_codec.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop::offline {
namespace {

constexpr std::size_t width = LiftedLinear::components;

double squared_norm(const float* block) {
  double sum = 0;
  for (std::size_t k = 0; k < width; ++k) sum += static_cast<double>(block[k]) * static_cast<double>(block[k]);
  return sum;
}

}  // namespace

TransformedColumn transform_column(const LiftedLinear& wavelet, const Eigen::MatrixXd& block, std::size_t j,
                                   double area, const std::vector<std::size_t>& near_nodes) {
  const std::size_t rows = wavelet.rows();
  std::vector<double> x((rows + 1) * width, 0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    const double* source = block.data() + static_cast<std::size_t>(block.rows()) * (3 * j + c);
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t r = 0; r < 3; ++r) x[width * i + 3 * c + r] = source[3 * i + r];
    }
  }
  TransformedColumn column;
  column.area = area;
  column.values.assign(x.begin(), x.end());
  for (std::size_t i = 0; i < rows; ++i) {
    const double squared = squared_norm(column.values.data() + width * i);
    column.energy += squared;
    column.largest = std::max(column.largest, squared);
  }
  column.largest = std::sqrt(column.largest);
  wavelet.forward(x.data());
  column.coefficients.assign(x.begin(), x.end());
  column.norms.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    column.norms[i] = static_cast<float>(std::sqrt(squared_norm(column.coefficients.data() + width * i)));
  }
  const auto& nodes = wavelet.nodes();
  for (const std::size_t node : near_nodes) {
    const auto row = std::lower_bound(nodes.begin(), nodes.end(), node);
    if (row != nodes.end() && *row == node) column.near.push_back(static_cast<std::size_t>(row - nodes.begin()));
  }
  return column;
}

std::size_t EncodedColumn::blocks() const {
  std::size_t count = 0;
  for (const auto& level : levels) count += level.rows.size();
  return count;
}

void encode_column(const LiftedLinear& wavelet, const TransformedColumn& column, double threshold,
                   const std::vector<std::uint32_t>& value_bytes, EncodedColumn& encoded) {
  encoded.levels.resize(wavelet.levels());
  auto near = column.near.begin();
  for (std::size_t l = 0; l < wavelet.levels(); ++l) {
    auto& level = encoded.levels[l];
    level.rows.clear();
    level.values.clear();
    const std::size_t begin = wavelet.row_begin(l), end = wavelet.row_begin(l + 1);
    const double least =
        l == 0 ? 0.0 : std::ldexp(threshold, static_cast<int>(l) - static_cast<int>(wavelet.levels() - 1));
    float largest = 0;
    for (std::size_t i = begin; i < end; ++i) {
      while (near != column.near.end() && *near < i) ++near;
      const bool is_near = near != column.near.end() && *near == i;
      if (!is_near && static_cast<double>(column.norms[i]) < least) continue;
      level.rows.push_back(static_cast<std::uint32_t>(i - begin));
      const float* block = column.coefficients.data() + width * i;
      for (std::size_t k = 0; k < width; ++k) largest = std::max(largest, std::abs(block[k]));
    }
    const float quanta = value_bytes[l] == 1 ? 127.0F : 32767.0F;
    level.scale = largest / quanta;
    level.values.reserve(width * level.rows.size());
    for (const std::uint32_t row : level.rows) {
      const float* block = column.coefficients.data() + width * (begin + row);
      for (std::size_t k = 0; k < width; ++k) {
        const float quantum = level.scale > 0 ? std::nearbyint(block[k] / level.scale) : 0.0F;
        level.values.push_back(static_cast<std::int16_t>(std::clamp(quantum, -quanta, quanta)));
      }
    }
  }
}

void decode_column(const LiftedLinear& wavelet, const EncodedColumn& encoded, std::vector<float>& values) {
  values.assign((wavelet.rows() + 1) * width, 0.0F);
  for (std::size_t l = 0; l < wavelet.levels(); ++l) {
    const auto& level = encoded.levels[l];
    for (std::size_t b = 0; b < level.rows.size(); ++b) {
      float* block = values.data() + width * (wavelet.row_begin(l) + level.rows[b]);
      for (std::size_t k = 0; k < width; ++k) {
        block[k] = level.scale * static_cast<float>(level.values[width * b + k]);
      }
    }
  }
  wavelet.inverse(values.data());
}

ColumnError column_error(const TransformedColumn& exact, const std::vector<float>& values) {
  ColumnError error;
  double largest = 0;
  for (std::size_t i = 0; i + width < values.size(); i += width) {
    double squared = 0;
    for (std::size_t k = 0; k < width; ++k) {
      const double difference = static_cast<double>(values[i + k]) - static_cast<double>(exact.values[i + k]);
      squared += difference * difference;
    }
    error.energy += squared;
    largest = std::max(largest, squared);
  }
  error.largest = exact.largest > 0 ? std::sqrt(largest) / exact.largest : 0.0;
  return error;
}

}  // namespace greenloop::offline
