#pragma once

#include <cstdint>

#include "formats/stored_blocks.hpp"
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
