#include "runtime/algebra/cholesky.hpp"

#include <cfloat>
#include <cstddef>
#include <cstring>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "runtime/algebra/processor.hpp"

namespace greenloop {
namespace {

constexpr float rounding = 8 * FLT_EPSILON;

// a matrix by columns of whole vectors
struct Columns {
  Float4* data;
  std::uint32_t stride;   ///< vectors from column to column
  std::uint32_t vectors;  ///< of them in use

  [[nodiscard]] Float4* vector(std::uint32_t column) const { return data + std::size_t{column} * stride; }
  float& operator()(std::uint32_t row, std::uint32_t column) const {
    return reinterpret_cast<float*>(vector(column))[row];
  }
};

// extends the lower triangle to whole vectors by the identity
void pad(std::uint32_t order, const Columns& a) {
  const std::uint32_t n = 4 * a.vectors;
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = order; i < n; ++i) {
      a(i, j) = i == j ? 1.0F : 0.0F;
    }
  }
}

// the four columns from `first`: inverse pivots, multipliers of L; false if one is not positive
bool factor_panel(const Columns& a, std::uint32_t first, const float (&least)[4]) {
  for (std::uint32_t k = first; k < first + 4; ++k) {
    const float pivot = a(k, k);
    if (!(pivot > least[k - first] && pivot <= FLT_MAX)) {
      return false;
    }
    const float inverse = 1.0F / pivot;
    a(k, k) = inverse;
    for (std::uint32_t j = k + 1; j < first + 4; ++j) {
      const float factor = a(j, k) * inverse;
      for (std::uint32_t i = j; i < first + 4; ++i) {
        a(i, j) -= a(i, k) * factor;
      }
      for (std::uint32_t v = first / 4 + 1; v < a.vectors; ++v) {
        a.vector(j)[v] -= a.vector(k)[v] * splat(factor);
      }
    }
    for (std::uint32_t i = k + 1; i < first + 4; ++i) {
      a(i, k) *= inverse;
    }
    for (std::uint32_t v = first / 4 + 1; v < a.vectors; ++v) {
      a.vector(k)[v] *= splat(inverse);
    }
  }
  return true;
}

// b[begin..end) -= the four columns from `first`, times x, in the order of the columns
void subtract_panel(const Columns& a, std::uint32_t first, const float (&x)[4], std::uint32_t begin, std::uint32_t end,
                    Float4* b) {
  const Float4* c0 = a.vector(first);
  const Float4* c1 = a.vector(first + 1);
  const Float4* c2 = a.vector(first + 2);
  const Float4* c3 = a.vector(first + 3);
  const Float4 x0 = splat(x[0]);
  const Float4 x1 = splat(x[1]);
  const Float4 x2 = splat(x[2]);
  const Float4 x3 = splat(x[3]);
  for (std::uint32_t v = begin; v < end; ++v) {
    b[v] = (((b[v] - c0[v] * x0) - c1[v] * x1) - c2[v] * x2) - c3[v] * x3;
  }
}

// four multipliers of each of two columns
struct TwoMultipliers {
  float of[2][4];
};

// subtract_panel of two columns b, which read the four once
void subtract_two(const Columns& a, std::uint32_t first, const TwoMultipliers& x, std::uint32_t begin, Float4* b0,
                  Float4* b1) {
  const Float4* c0 = a.vector(first);
  const Float4* c1 = a.vector(first + 1);
  const Float4* c2 = a.vector(first + 2);
  const Float4* c3 = a.vector(first + 3);
  const auto subtracted = [&](const float(&of)[4], std::uint32_t v, Float4 b) {
    return (((b - c0[v] * splat(of[0])) - c1[v] * splat(of[1])) - c2[v] * splat(of[2])) - c3[v] * splat(of[3]);
  };
  for (std::uint32_t v = begin; v < a.vectors; ++v) {
    const Float4 other = subtracted(x.of[1], v, b1[v]);
    b0[v] = subtracted(x.of[0], v, b0[v]);
    b1[v] = other;
  }
}

#if defined(__x86_64__)
// two vectors in one operation, each lane as subtract_two has it
[[gnu::target("avx2")]] void subtract_two_avx2(const Columns& a, std::uint32_t first, const TwoMultipliers& x,
                                               std::uint32_t begin, Float4* b0, Float4* b1) {
  const auto columns = [&](std::uint32_t k) { return reinterpret_cast<const float*>(a.vector(first + k)); };
  const float* const c[4] = {columns(0), columns(1), columns(2), columns(3)};
  __m256 x0[4];
  __m256 x1[4];
  for (std::size_t k = 0; k < 4; ++k) {
    x0[k] = _mm256_set1_ps(x.of[0][k]);
    x1[k] = _mm256_set1_ps(x.of[1][k]);
  }
  std::uint32_t v = begin;
  for (; v + 2 <= a.vectors; v += 2) {
    auto* const at0 = reinterpret_cast<float*>(b0 + v);
    auto* const at1 = reinterpret_cast<float*>(b1 + v);
    __m256 left0 = _mm256_loadu_ps(at0);
    __m256 left1 = _mm256_loadu_ps(at1);
    for (std::size_t k = 0; k < 4; ++k) {
      const __m256 column = _mm256_loadu_ps(c[k] + std::size_t{4} * v);
      left0 = _mm256_sub_ps(left0, _mm256_mul_ps(column, x0[k]));
      left1 = _mm256_sub_ps(left1, _mm256_mul_ps(column, x1[k]));
    }
    _mm256_storeu_ps(at0, left0);
    _mm256_storeu_ps(at1, left1);
  }
  _mm256_zeroupper();
  subtract_two(a, first, x, v, b0, b1);
}
#endif

// unit lower triangle of the four columns from `first`, applied backwards to four entries
Float4 solve_lower(const Columns& a, std::uint32_t first, Float4 b) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    for (std::uint32_t i = k + 1; i < 4; ++i) {
      b[i] -= a(first + i, first + k) * b[k];
    }
  }
  return b;
}

// the same, transposed
Float4 solve_upper(const Columns& a, std::uint32_t first, Float4 b) {
  for (std::uint32_t k = 4; k-- > 0;) {
    for (std::uint32_t i = k + 1; i < 4; ++i) {
      b[k] -= a(first + i, first + k) * b[i];
    }
  }
  return b;
}

// b = L^-1 b
void solve_forward(const Columns& a, Float4* b) {
  for (std::uint32_t v = 0; v < a.vectors; ++v) {
    b[v] = solve_lower(a, 4 * v, b[v]);
    const float x[4] = {b[v][0], b[v][1], b[v][2], b[v][3]};
    subtract_panel(a, 4 * v, x, v + 1, a.vectors, b);
  }
}

// products of the four columns from `first` with b below them
Float4 dot_panel(const Columns& a, std::uint32_t first, const Float4* b) {
  Float4 sum[4] = {};
  for (std::uint32_t v = first / 4 + 1; v < a.vectors; ++v) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      sum[k] += a.vector(first + k)[v] * b[v];
    }
  }
  Float4 total{};
  for (std::uint32_t k = 0; k < 4; ++k) {
    total[k] = (sum[k][0] + sum[k][1]) + (sum[k][2] + sum[k][3]);
  }
  return total;
}

// factors of A + alpha w w^T, alpha positive, where w is 0 above row `first`; w is overwritten
void update(const Columns& a, std::uint32_t order, std::uint32_t first, float alpha, Float4* vector) {
  auto* w = reinterpret_cast<float*>(vector);
  for (std::uint32_t j = first; j < order; ++j) {
    const float p = w[j];
    const float pivot = 1.0F / a(j, j);
    const float updated = pivot + alpha * p * p;
    const float inverse = 1.0F / updated;
    const float gain = p * alpha * inverse;
    alpha *= pivot * inverse;
    a(j, j) = inverse;
    std::uint32_t i = j + 1;
    for (; i % 4 != 0; ++i) {
      w[i] -= p * a(i, j);
      a(i, j) += gain * w[i];
    }
    Float4* column = a.vector(j);
    for (std::uint32_t v = i / 4; v < a.vectors; ++v) {
      vector[v] -= splat(p) * column[v];
      column[v] += splat(gain) * vector[v];
    }
  }
}

// subtract: subtract_two in some form
template <class Subtract>
bool factor(std::uint32_t order, std::uint32_t stride, Float4* data, Subtract subtract) {
  const Columns a{data, stride / 4, padded_order(order) / 4};
  const std::uint32_t n = 4 * a.vectors;
  pad(order, a);
  // columns are updated from the left, so the diagonal still is the matrix's own
  for (std::uint32_t first = 0; first < n; first += 4) {
    float least[4];
    for (std::uint32_t k = 0; k < 4; ++k) {
      const float diagonal = a(first + k, first + k);
      least[k] = diagonal > 0 ? rounding * diagonal : 0;
    }
    for (std::uint32_t done = 0; done < first; done += 4) {
      const Float4 inverse = {a(done, done), a(done + 1, done + 1), a(done + 2, done + 2), a(done + 3, done + 3)};
      const Float4 pivot = splat(1.0F) / inverse;
      for (std::uint32_t j = first; j < first + 4; j += 2) {
        TwoMultipliers x;
        for (std::uint32_t k = 0; k < 4; ++k) {
          x.of[0][k] = a(j, done + k) * pivot[k];
          x.of[1][k] = a(j + 1, done + k) * pivot[k];
        }
        subtract(a, done, x, first / 4, a.vector(j), a.vector(j + 1));
      }
    }
    if (!factor_panel(a, first, least)) {
      return false;
    }
  }
  return true;
}

#if defined(__x86_64__)
bool cholesky_factor_avx2(std::uint32_t order, std::uint32_t stride, Float4* data) noexcept {
  return factor(order, stride, data, subtract_two_avx2);
}
#endif

}  // namespace

bool cholesky_factor(std::uint32_t order, std::uint32_t stride, Float4* data) noexcept {
  return factor(order, stride, data, subtract_two);
}

CholeskyFactor fastest_cholesky_factor() noexcept {
#if defined(__x86_64__)
  if (has_avx2()) {
    return cholesky_factor_avx2;
  }
#endif
  return cholesky_factor;
}

void cholesky_solve(std::uint32_t order, std::uint32_t stride, const Float4* data, Float4* b) noexcept {
  const Columns a{const_cast<Float4*>(data), stride / 4, padded_order(order) / 4};
  solve_forward(a, b);
  for (std::uint32_t v = a.vectors; v-- > 0;) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      b[v][k] *= a(4 * v + k, 4 * v + k);
    }
    b[v] = solve_upper(a, 4 * v, b[v] - dot_panel(a, 4 * v, b));
  }
}

bool cholesky_append(std::uint32_t order, std::uint32_t added, std::uint32_t stride, Float4* data,
                     Float4* border) noexcept {
  pad(order, {data, stride / 4, padded_order(order + added) / 4});
  for (std::uint32_t row = order; row < order + added; ++row, border += stride / 4) {
    const Columns a{data, stride / 4, padded_order(row + 1) / 4};
    auto* entry = reinterpret_cast<float*>(border);
    const float diagonal = entry[row];
    for (std::uint32_t k = row; k < 4 * a.vectors; ++k) {
      entry[k] = 0;
    }
    solve_forward(a, border);
    float pivot = diagonal;
    for (std::uint32_t k = 0; k < row; ++k) {
      const float multiplier = entry[k] * a(k, k);
      pivot -= entry[k] * multiplier;
      a(row, k) = multiplier;
    }
    if (!(diagonal > 0 && pivot > rounding * diagonal && pivot <= FLT_MAX)) {
      return false;
    }
    a(row, row) = 1.0F / pivot;
  }
  return true;
}

void cholesky_remove(std::uint32_t order, std::uint32_t first, std::uint32_t removed, std::uint32_t stride,
                     Float4* data, Float4* scratch) noexcept {
  const Columns a{data, stride / 4, padded_order(order) / 4};
  for (std::uint32_t c = 0; c < removed; ++c) {
    Float4* column = scratch + std::size_t{c} * a.stride;
    std::memcpy(column, a.vector(first + c), sizeof(Float4) * a.vectors);
    update(a, order, first + removed, 1.0F / a(first + c, first + c), column);
  }
  const std::size_t below = sizeof(float) * (order - first - removed);
  for (std::uint32_t j = 0; j < first; ++j) {
    std::memmove(&a(first, j), &a(first + removed, j), below);
  }
  for (std::uint32_t j = first; j + removed < order; ++j) {
    std::memcpy(&a(j, j), &a(j + removed, j + removed), sizeof(float) * (order - removed - j));
  }
  pad(order - removed, {data, stride / 4, padded_order(order - removed) / 4});
}

}  // namespace greenloop
