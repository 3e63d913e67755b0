#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"

namespace greenloop {

/// Tiles that hold the first `coefficients`.
constexpr std::uint32_t tiles_of(std::uint32_t coefficients) {
  return (coefficients + BaseColumns::width - 1) / BaseColumns::width;
}

/// Bytes of the columns' values.
template <unsigned N>
constexpr std::uint64_t value_bytes(const BaseColumns& base) {
  return std::uint64_t{BaseColumns::tile_bytes<N>} * base.tiles * base.columns;
}

/// Which base columns a model has, without their values: none if too few of their blocks exist. Start-up; linear in the
/// blocks, times the logarithm of a column's length.
[[nodiscard]] BaseColumns base_columns_of(const ElastostaticView& view) noexcept;

/// Fills in their values. value: [value_bytes], zero. Start-up; work: as base_columns_of.
template <unsigned N>
void fill_base_columns(const ElastostaticView& view, const BaseColumns& base, std::byte* value) noexcept;

}  // namespace greenloop
