#pragma once

#include <cstdint>

#include "formats/layout.hpp"

namespace greenloop {

// A column of the Green's function: a node of the domain as one of a constraint level, in one number. Coarser levels
// come first, then places.

inline constexpr std::uint32_t column_place_bits = 28;
static_assert(layout::max_levels <= 1U << (32 - column_place_bits));

/// place: in the domain, less than 2^28.
constexpr std::uint32_t make_column(std::uint32_t level, std::uint32_t place) {
  return level << column_place_bits | place;
}
constexpr std::uint32_t column_level(std::uint32_t column) { return column >> column_place_bits; }
/// Some columns, in place.
struct ColumnSet {
  std::uint32_t count = 0;
  const std::uint32_t* column = nullptr;  ///< [count]
};

constexpr std::uint32_t column_place(std::uint32_t column) { return column & ((1U << column_place_bits) - 1); }

}  // namespace greenloop
