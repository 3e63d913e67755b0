#include "runtime/lu.hpp"

#include <cfloat>
#include <cstddef>

namespace greenloop {
namespace {

// a matrix by columns of whole vectors
struct Columns {
  Float4* data;
  std::uint32_t vectors;  ///< per column

  [[nodiscard]] Float4* vector(std::uint32_t column) const { return data + std::size_t{column} * vectors; }
  float& operator()(std::uint32_t row, std::uint32_t column) const {
    return reinterpret_cast<float*>(vector(column))[row];
  }
};

float magnitude(float value) { return value < 0 ? -value : value; }

float largest_entry(std::uint32_t order, const Columns& a) {
  float largest = 0;
  for (std::uint32_t j = 0; j < order; ++j) {
    for (std::uint32_t i = 0; i < order; ++i) {
      const float entry = magnitude(a(i, j));
      largest = entry > largest ? entry : largest;
    }
  }
  return largest;
}

// extends the matrix to whole vectors by `diagonal` times the identity
void pad(std::uint32_t order, float diagonal, const Columns& a) {
  const std::uint32_t n = 4 * a.vectors;
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = j < order ? order : 0; i < n; ++i) {
      a(i, j) = i == j ? diagonal : 0;
    }
  }
}

std::uint32_t pivot_row(const Columns& a, std::uint32_t k) {
  std::uint32_t row = k;
  for (std::uint32_t i = k + 1; i < 4 * a.vectors; ++i) {
    row = magnitude(a(i, k)) > magnitude(a(row, k)) ? i : row;
  }
  return row;
}

void exchange_rows(const Columns& a, std::uint32_t j, std::uint32_t k, std::uint32_t row) {
  const float kept = a(k, j);
  a(k, j) = a(row, j);
  a(row, j) = kept;
}

// one column of the panel that begins at column `first`: pivot, multipliers, and their effect within the panel
bool eliminate_in_panel(const Columns& a, std::uint32_t first, std::uint32_t k, float tolerance,
                        std::uint32_t* exchange) {
  const std::uint32_t row = pivot_row(a, k);
  exchange[k] = row;
  for (std::uint32_t j = first; j < first + 4; ++j) {
    exchange_rows(a, j, k, row);
  }
  if (!(magnitude(a(k, k)) > tolerance)) {
    return false;
  }
  const float inverse = 1.0F / a(k, k);
  a(k, k) = inverse;
  for (std::uint32_t i = k + 1; i < first + 4; ++i) {
    a(i, k) *= inverse;
  }
  for (std::uint32_t v = first / 4 + 1; v < a.vectors; ++v) {
    a.vector(k)[v] *= splat(inverse);
  }
  for (std::uint32_t j = k + 1; j < first + 4; ++j) {
    const float factor = a(k, j);
    for (std::uint32_t i = k + 1; i < first + 4; ++i) {
      a(i, j) -= a(i, k) * factor;
    }
    for (std::uint32_t v = first / 4 + 1; v < a.vectors; ++v) {
      a.vector(j)[v] -= a.vector(k)[v] * splat(factor);
    }
  }
  return true;
}

// unit lower triangle of the four columns from `first`, applied backwards to four entries
Float4 solve_unit_lower(const Columns& a, std::uint32_t first, Float4 b) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    for (std::uint32_t i = k + 1; i < 4; ++i) {
      b[i] -= a(first + i, first + k) * b[k];
    }
  }
  return b;
}

Float4 solve_upper(const Columns& a, std::uint32_t first, Float4 b) {
  for (std::uint32_t k = 4; k-- > 0;) {
    b[k] *= a(first + k, first + k);
    for (std::uint32_t i = 0; i < k; ++i) {
      b[i] -= a(first + i, first + k) * b[k];
    }
  }
  return b;
}

// b[begin..end) -= the four columns from `first`, times x, in the order of the columns
void subtract_panel(const Columns& a, std::uint32_t first, Float4 x, std::uint32_t begin, std::uint32_t end,
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

}  // namespace

bool lu_factor(std::uint32_t order, Float4* data, std::uint32_t* exchange) noexcept {
  const Columns a{data, lu_padded(order) / 4};
  const std::uint32_t n = 4 * a.vectors;
  const float largest = largest_entry(order, a);
  const float tolerance = static_cast<float>(order) * FLT_EPSILON * largest;
  pad(order, largest, a);

  for (std::uint32_t first = 0; first < n; first += 4) {
    for (std::uint32_t k = first; k < first + 4; ++k) {
      if (!eliminate_in_panel(a, first, k, tolerance, exchange)) {
        return false;
      }
    }
    for (std::uint32_t j = 0; j < n; ++j) {
      if (j == first) {
        j += 3;
        continue;
      }
      for (std::uint32_t k = first; k < first + 4; ++k) {
        exchange_rows(a, j, k, exchange[k]);
      }
      if (j > first) {
        Float4* column = a.vector(j);
        column[first / 4] = solve_unit_lower(a, first, column[first / 4]);
        subtract_panel(a, first, column[first / 4], first / 4 + 1, a.vectors, column);
      }
    }
  }
  return true;
}

void lu_solve(std::uint32_t order, const Float4* data, const std::uint32_t* exchange, Float4* b) noexcept {
  const Columns a{const_cast<Float4*>(data), lu_padded(order) / 4};
  auto* entry = reinterpret_cast<float*>(b);
  for (std::uint32_t k = 0; k < 4 * a.vectors; ++k) {
    const float kept = entry[k];
    entry[k] = entry[exchange[k]];
    entry[exchange[k]] = kept;
  }
  for (std::uint32_t v = 0; v < a.vectors; ++v) {
    b[v] = solve_unit_lower(a, 4 * v, b[v]);
    subtract_panel(a, 4 * v, b[v], v + 1, a.vectors, b);
  }
  for (std::uint32_t v = a.vectors; v-- > 0;) {
    b[v] = solve_upper(a, 4 * v, b[v]);
    subtract_panel(a, 4 * v, b[v], 0, v, b);
  }
}

}  // namespace greenloop
