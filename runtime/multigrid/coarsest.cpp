#include "runtime/multigrid/coarsest.hpp"

#include <cstddef>

namespace greenloop {
namespace {

constexpr std::size_t row_start(std::size_t row) { return row * (row + 1) / 2; }

/// L y = b in place, row by row.
void substitute_forwards(std::span<const double> lower, std::span<double> y) {
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double* const row = lower.data() + row_start(i);
    double sum[4] = {};
    std::size_t j = 0;
    for (; j + 4 <= i; j += 4) {
      for (std::size_t k = 0; k < 4; ++k) sum[k] += row[j + k] * y[j + k];
    }
    for (; j < i; ++j) sum[0] += row[j] * y[j];
    y[i] = (y[i] - ((sum[0] + sum[1]) + (sum[2] + sum[3]))) * row[i];
  }
}

/// L^T x = y in place, column by column of L^T.
void substitute_backwards(std::span<const double> lower, std::span<double> x) {
  for (std::size_t i = x.size(); i-- > 0;) {
    const double* const row = lower.data() + row_start(i);
    x[i] *= row[i];
    for (std::size_t j = 0; j < i; ++j) x[j] -= row[j] * x[i];
  }
}

}  // namespace

void solve_coarsest(const CoarsestFactor& factor, std::span<const Float4> b, std::span<double> scratch,
                    std::span<Float4> x) noexcept {
  for (std::size_t v = 0; v < factor.vertices; ++v) {
    for (std::size_t i = 0; i < 3; ++i) scratch[3 * v + i] = static_cast<double>(b[v][i]);
  }
  substitute_forwards(factor.lower, scratch);
  substitute_backwards(factor.lower, scratch);
  for (std::size_t v = 0; v < factor.vertices; ++v) {
    x[v] = Float4{static_cast<float>(scratch[3 * v]), static_cast<float>(scratch[3 * v + 1]),
                  static_cast<float>(scratch[3 * v + 2]), 0.0F};
  }
}

}  // namespace greenloop
