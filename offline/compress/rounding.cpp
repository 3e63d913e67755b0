#include "offline/compress/rounding.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace greenloop::offline {
namespace {

constexpr std::size_t width = LiftedLinear::components;

using Block = std::array<float, width>;

/// What is left of the column that shape can still explain.
Block project(const WaveletShapes::Entry* begin, const WaveletShapes::Entry* end, const std::vector<float>& residual) {
  Block sum{};
  for (const auto* entry = begin; entry != end; ++entry) {
    const float* r = residual.data() + width * entry->row;
    for (std::size_t k = 0; k < width; ++k) sum[k] += entry->value * r[k];
  }
  return sum;
}

void subtract(const WaveletShapes::Entry* begin, const WaveletShapes::Entry* end, const Block& step,
              std::vector<float>& residual) {
  for (const auto* entry = begin; entry != end; ++entry) {
    float* r = residual.data() + width * entry->row;
    for (std::size_t k = 0; k < width; ++k) r[k] -= entry->value * step[k];
  }
}

}  // namespace

WaveletShapes::WaveletShapes(const LiftedLinear& wavelet) {
  const std::size_t rows = wavelet.rows();
  begin_.push_back(0);
  std::vector<double> x;
  // nine unit coefficients at a time, one in each component
  for (std::size_t first = 0; first < rows; first += width) {
    const std::size_t count = std::min(width, rows - first);
    x.assign((rows + 1) * width, 0.0);
    for (std::size_t k = 0; k < count; ++k) x[width * (first + k) + k] = 1.0;
    wavelet.inverse(x.data());
    for (std::size_t k = 0; k < count; ++k) {
      double squared = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        const double value = x[width * i + k];
        if (value == 0) continue;
        entries_.push_back({static_cast<std::uint32_t>(i), static_cast<float>(value)});
        squared += value * value;
      }
      begin_.push_back(entries_.size());
      squared_norm_.push_back(static_cast<float>(squared));
    }
  }
}

void refine_quanta(const LiftedLinear& wavelet, const WaveletShapes& shapes, const TransformedColumn& column,
                   const std::vector<std::uint32_t>& value_bytes, const std::vector<float>& values, int sweeps,
                   EncodedColumn& encoded) {
  std::vector<float> residual(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) residual[i] = column.values[i] - values[i];
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t l = 0; l < encoded.levels.size(); ++l) {
      auto& level = encoded.levels[l];
      if (!(level.scale > 0)) continue;
      const float quanta = value_bytes[l] == 1 ? 127.0F : 32767.0F;
      for (std::size_t b = 0; b < level.rows.size(); ++b) {
        const std::size_t row = wavelet.row_begin(l) + level.rows[b];
        Block step = project(shapes.begin(row), shapes.end(row), residual);
        const float to_quanta = 1.0F / (shapes.squared_norm(row) * level.scale);
        bool moved = false;
        for (std::size_t k = 0; k < width; ++k) {
          auto& value = level.values[width * b + k];
          const float wanted = static_cast<float>(value) + std::nearbyint(step[k] * to_quanta);
          const float quantum = std::clamp(wanted, -quanta, quanta);
          step[k] = level.scale * (quantum - static_cast<float>(value));
          moved = moved || step[k] != 0;
          value = static_cast<std::int16_t>(quantum);
        }
        if (moved) subtract(shapes.begin(row), shapes.end(row), step, residual);
      }
    }
  }
}

}  // namespace greenloop::offline
