#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "formats/view.hpp"

namespace greenloop {

// Reading the blocks of couplings and predictions in place: see layout::CouplingsHeader and PredictionsHeader. All of
// constant work but for the sum over a model; none throws or allocates.

/// Blocks of a section.
inline std::uint32_t block_count(const CouplingsView& view) { return view.begin[view.columns]; }

/// Blocks of layers first .. end-1, over all levels. Work: a read per section.
inline std::uint64_t block_count(const ElastostaticView& view, std::uint32_t first, std::uint32_t end) {
  std::uint64_t blocks = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t layer = first; layer < end; ++layer) {
      blocks += block_count(view.level[q].couplings[layer]);
    }
  }
  return blocks;
}

/// Row of a block, by its place in the section.
inline std::uint32_t stored_row(const CouplingsView& view, std::uint32_t block) {
  return view.index_bytes == 2 ? static_cast<const std::uint16_t*>(view.index)[block]
                               : static_cast<const std::uint32_t*>(view.index)[block];
}

/// Blocks of a column; a section without blocks has no columns.
inline std::uint32_t column_length(const CouplingsView& view, std::uint32_t column) {
  return view.columns == 0 ? 0 : view.begin[column + 1] - view.begin[column];
}

/// Calls visit(row, position) for the blocks of a column in rows first .. end-1, by rows. Work: the logarithm of the
/// column's length, and one visit a block.
template <class Visit>
void visit_rows(const CouplingsView& view, std::uint32_t column, std::uint32_t first, std::uint32_t end, Visit visit) {
  if (view.columns == 0) {
    return;
  }
  const auto visit_index = [&](const auto* index) {
    const auto* last = index + view.begin[column + 1];
    const auto* at = std::lower_bound(index + view.begin[column], last, first);
    for (; at != last && *at < end; ++at) {
      visit(std::uint32_t{*at}, static_cast<std::uint32_t>(at - index));
    }
  };
  if (view.index_bytes == 2) {
    visit_index(static_cast<const std::uint16_t*>(view.index));
  } else {
    visit_index(static_cast<const std::uint32_t*>(view.index));
  }
}

/// Element k of a block of N x N, in quanta; value_bits: the layer's.
template <unsigned N>
std::int16_t stored_value(const CouplingsView& view, std::uint32_t value_bits, std::uint32_t block, std::uint32_t k) {
  if (value_bits == 4) {
    const int byte = std::to_integer<int>(view.value[layout::block_bytes(N, 4) * block + k / 2]);
    const int nibble = k % 2 == 0 ? byte & 15 : byte >> 4;
    return static_cast<std::int16_t>(nibble < 8 ? nibble : nibble - 16);
  }
  const std::size_t at = std::size_t{N} * N * block + k;
  if (value_bits == 8) {
    return static_cast<std::int8_t>(view.value[at]);
  }
  std::int16_t value;
  std::memcpy(&value, view.value + 2 * at, sizeof value);
  return value;
}

/// Place, among all domain nodes, of what a prediction is from; term: node of the level times terms, plus its own.
inline std::uint32_t stored_source(const PredictionsView& view, std::size_t term) {
  return view.index_bytes == 2 ? static_cast<const std::uint16_t*>(view.index)[term]
                               : static_cast<const std::uint32_t*>(view.index)[term];
}

/// Element k of its weight, N x N, in units of layout::prediction_unit.
template <unsigned N>
std::int16_t stored_weight(const PredictionsView& view, std::size_t term, std::uint32_t k) {
  std::int16_t value;
  std::memcpy(&value, view.weight + 2 * (std::size_t{N} * N * term + k), sizeof value);
  return value;
}

}  // namespace greenloop
