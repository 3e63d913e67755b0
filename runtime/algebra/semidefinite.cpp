#include "runtime/algebra/semidefinite.hpp"

#include <cfloat>
#include <cstddef>

namespace greenloop {
namespace {

// takes column j, times its share, off the columns behind it
void eliminate(std::uint32_t order, std::uint32_t stride, std::uint32_t j, float inverse, float* a) {
  const float* const column = a + std::size_t{stride} * j;
  for (std::uint32_t c = j + 1; c < order; ++c) {
    float* const behind = a + std::size_t{stride} * c;
    const float part = inverse * column[c];
    for (std::uint32_t r = c; r < order; ++r) {
      behind[r] -= part * column[r];
    }
  }
}

}  // namespace

std::uint32_t factor_semidefinite(std::uint32_t order, std::uint32_t stride, float share, float* a,
                                  float* diagonal) noexcept {
  std::uint32_t left_out = 0;
  for (std::uint32_t j = 0; j < order; ++j) {
    diagonal[j] = a[std::size_t{stride} * j + j];
  }
  for (std::uint32_t j = 0; j < order; ++j) {
    float* const column = a + std::size_t{stride} * j;
    const bool stands = column[j] > share * diagonal[j] && 1 / column[j] <= FLT_MAX && column[j] <= FLT_MAX;
    const float inverse = stands ? 1 / column[j] : 0;
    if (stands) {
      eliminate(order, stride, j, inverse, a);
    } else {
      ++left_out;
    }
    for (std::uint32_t r = j + 1; r < order; ++r) {
      column[r] = stands ? inverse * column[r] : 0;
    }
    column[j] = inverse;
  }
  return left_out;
}

void solve_semidefinite(std::uint32_t order, std::uint32_t stride, const float* a, float* b) noexcept {
  for (std::uint32_t j = 0; j < order; ++j) {
    const float* const column = a + std::size_t{stride} * j;
    for (std::uint32_t r = j + 1; r < order; ++r) {
      b[r] -= column[r] * b[j];
    }
  }
  for (std::uint32_t j = order; j-- > 0;) {
    const float* const column = a + std::size_t{stride} * j;
    float sum = column[j] * b[j];
    for (std::uint32_t r = j + 1; r < order; ++r) {
      sum -= column[r] * b[r];
    }
    b[j] = sum;
  }
}

}  // namespace greenloop
