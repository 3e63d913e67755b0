#pragma once

#include <cstdint>
#include <cstring>

#include "formats/view.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

/// The averages or the details of one level, in a numbering of all coefficients of the two-sided form.
struct CoefficientGroup {
  const layout::Scale* scale = nullptr;  ///< [count]
  std::uint32_t begin = 0;               ///< its first coefficient
  std::uint32_t count = 0;
  std::uint32_t level = 0;
};

/// All coefficients: the averages of level 0 and the details of every level, by place in the domain, then the averages
/// of levels 1..last_averages.
struct Coefficients {
  static constexpr std::uint32_t groups = 2 * layout::max_levels;
  static constexpr std::uint32_t details(std::uint32_t level) { return level; }
  static constexpr std::uint32_t averages(std::uint32_t level) { return level == 0 ? 0 : layout::max_levels + level; }
  /// Averages of level 1 and above are partners only: no diagonal block is part of their row.
  static constexpr bool has_diagonal(std::uint32_t group) { return group < layout::max_levels; }

  CoefficientGroup group[groups];
  std::uint32_t count = 0;
  std::uint32_t last_averages = 0;  ///< max(L - 2, 0)
};

/// Start-up; linear in the levels.
[[nodiscard]] Coefficients number_coefficients(const ModelView& view) noexcept;

/// A symmetric matrix of a scale as a block; its fourth lanes are undefined.
inline Block symmetric_block(const float (&matrix)[6]) {
  Float4 low;
  Float4 high;
  std::memcpy(&low, matrix, sizeof low);
  std::memcpy(&high, matrix + 2, sizeof high);
  return {{low, __builtin_shufflevector(low, high, 1, 3, 6, 6), __builtin_shufflevector(high, high, 0, 2, 3, 3)}};
}

/// symmetric matrix times vector; the fourth lane is 0.
inline Float4 symmetric_product(const float (&matrix)[6], Float4 x) {
  const Float4 splats[3] = {splat(x[0]), splat(x[1]), splat(x[2])};
  return xyz(product(symmetric_block(matrix), splats));
}

}  // namespace greenloop
