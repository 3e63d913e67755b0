#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/arena.hpp"
#include "runtime/coefficients.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

// Sums over the stored blocks of the symmetric compliance in non-standard form (Beylkin, Coifman & Rokhlin 1991): a
// block M of column j and row i adds M f_j to the displacement of i (direct) and M^T f_i to that of j (mirrored), all
// in scaled coefficients.

/// A stored block, seen from its row or its column.
struct BlockPlace {
  std::uint32_t target;    ///< coefficient within its group, or what stands for it
  std::uint32_t position;  ///< of the block in its section
};

/// Couplings(q, partner, strength) with an index by rows.
struct CouplingSection {
  CouplingsView view;
  std::uint32_t column_group = 0;
  std::uint32_t row_group = 0;
  std::uint32_t column_level = 0;
  std::uint32_t row_level = 0;
  std::uint32_t layer = 0;                        ///< layout::Strength
  float factor = 0;                               ///< value of one quantum, times the widening of the stored values
  const std::uint32_t* mirrored_begin = nullptr;  ///< [rows + 1] into mirrored
  const BlockPlace* mirrored = nullptr;           ///< [blocks] by rows; target: the column

  [[nodiscard]] std::uint32_t direct_length(std::uint32_t column) const {
    return view.begin[column + 1] - view.begin[column];
  }
  [[nodiscard]] std::uint32_t mirrored_length(std::uint32_t row) const {
    return mirrored_begin[row + 1] - mirrored_begin[row];
  }
};

/// All sections that hold blocks, coarse to fine.
struct Couplings {
  static constexpr std::uint32_t most = 3 * layout::strengths * layout::max_levels;
  std::uint32_t count = 0;
  const CouplingSection* section = nullptr;
};

/// The `n`-th of Couplings::most possible sections, without its mirrored index; false if the model has no blocks there.
[[nodiscard]] bool find_section(const ModelView& view, std::uint32_t n, CouplingSection& section) noexcept;

/// Carves the sections of a model and the mirrored index of each out of `arena` and fills them in, unless `arena` only
/// counts. Start-up; linear in the blocks.
[[nodiscard]] Couplings place_couplings(Arena& arena, const ModelView& view) noexcept;

/// Longest column and longest row of a section. Start-up; a pass over its blocks for every 1,024 rows.
struct LongestLists {
  std::uint32_t direct = 0;
  std::uint32_t mirrored = 0;
};
[[nodiscard]] LongestLists longest_lists(const CouplingSection& section) noexcept;

/// Scaled forces on some coefficients of a group.
struct SparseGroup {
  const std::uint32_t* list;  ///< [count] coefficients
  std::uint32_t count;
  std::uint32_t begin;  ///< the group's first coefficient
  const Float4* force;  ///< by coefficient
};

/// rows += the blocks of the columns with a force, times it. rows: [rows of the section]. For the loop; work: 9 units
/// per block, 4 per column.
void add_direct(const CouplingSection& section, const SparseGroup& columns, Float4* rows) noexcept;

/// columns += the transposed blocks of the rows with a force, times it.
void add_mirrored(const CouplingSection& section, const SparseGroup& rows, Float4* columns) noexcept;

/// The blocks of a column in the rows that have a slot (not layout::none), to be multiplied by
/// section.factor; target: the slot. The others are not decoded. Returns their number. places, blocks: [blocks of the
/// column + 1]. For the loop; work: 20 units per block.
std::uint32_t load_slotted(const CouplingSection& section, std::uint32_t column, const std::uint32_t* slot,
                           BlockPlace* places, Block* blocks) noexcept;

}  // namespace greenloop
