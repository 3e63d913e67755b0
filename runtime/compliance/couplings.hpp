#pragma once

#include <algorithm>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"

namespace greenloop {

// The stored couplings in place: the blocks of a coefficient's column, whose rows lie before it.

/// A stored block of a column.
struct BlockPlace {
  std::uint32_t target;    ///< what stands for its row
  std::uint32_t position;  ///< of the block in its section
};

/// Value of one quantum of a layer, times the widening of the stored values (see StoredBlock).
template <unsigned N>
[[nodiscard]] float block_factor(const layout::Info& info, std::uint32_t layer) noexcept;

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

/// The blocks of a column in the rows with a slot below `slots`, to be multiplied by block_factor; target: the slot.
/// The others are not decoded. Returns their number. slot: [rows], layout::none without one; places, blocks: [blocks of
/// the column + 1]. For the loop; work: 4 units per block, and N N + 3 for each that is returned.
template <unsigned N>
std::uint32_t load_slotted(const CouplingsView& view, std::uint32_t layer, std::uint32_t column,
                           const std::uint32_t* slot, std::uint32_t slots, BlockPlace* places,
                           Block<N>* blocks) noexcept;

/// Blocks between the coefficients of a level and those of another.
struct LevelPair {
  std::uint32_t all = 0;   ///< summed over the coefficients of the first: a block within one level counts twice
  std::uint32_t most = 0;  ///< of one of them
};

/// How many blocks there are, by pairs of levels.
struct CouplingCounts {
  bool countable = false;                                    ///< fewer than 2^30 blocks; else nothing is counted
  LevelPair stored[layout::max_levels][layout::max_levels];  ///< in all layers
  std::uint32_t longest_column = 0;                          ///< in one layer
};

/// Start-up; linear in the blocks and, for every 512 coefficients, in the coefficients.
[[nodiscard]] CouplingCounts count_couplings(const ModelView& view) noexcept;

}  // namespace greenloop
