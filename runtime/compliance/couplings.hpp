#pragma once

#include <cstdint>

#include "formats/stored_blocks.hpp"
#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"
#include "runtime/algebra/value_counts.hpp"

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

/// What a body's memory follows from.
struct CouplingCounts {
  bool countable = false;            ///< fewer than 2^30 blocks
  std::uint32_t longest_column = 0;  ///< in one layer
};

/// Start-up; linear in the coefficients.
[[nodiscard]] CouplingCounts count_couplings(const ModelView& view) noexcept;

// What bounds the blocks of a set of coefficients: those of any t of a level are no more than its t largest counts.

/// Blocks in the columns of level q's coefficients, in all layers. Start-up; linear in the coefficients.
void count_stored(const ModelView& view, std::uint32_t q, ValueCounts<>& counts) noexcept;

/// Levels first..last.
struct LevelRange {
  std::uint32_t first;
  std::uint32_t last;
};

/// Blocks of level q's coefficients with those of other levels, in all layers, without those that tiles of `base`
/// hold. A block within level q counts for both of its coefficients. Start-up; linear in the blocks and, for every
/// 1,024 coefficients, in the coefficients.
void count_blocks(const ModelView& view, std::uint32_t q, LevelRange others, const BaseColumns& base,
                  ValueCounts<>& counts) noexcept;

}  // namespace greenloop
