#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/arena.hpp"
#include "runtime/column.hpp"
#include "runtime/column_blocks.hpp"
#include "runtime/float4.hpp"
#include "runtime/sparse_forces.hpp"

namespace greenloop {

// What a unit force on a touchable node of a constraint level moves, in wavelet coefficients, as far as the nodes that
// are read depend on these: the columns that fields are sums of (James & Pai 2003, section 5.4). Made of all couplings
// at start-up and thresholded as layout.hpp says, so that a step reads a fraction of what the two-sided form would make
// it read. Values are upper halves of floats, which load without conversion.

/// The field columns of all constraint levels; nodes that stand for no touchable node have empty ones.
struct FieldColumns {
  std::uint32_t levels = 0;
  /// [c][domain nodes of K(c) * levels + 1] into block: of every node, by the level that is moved
  const std::uint32_t* begin[layout::max_levels] = {};
  const ColumnBlock* block = nullptr;
  AddBlocks add = add_blocks;  ///< what columns are summed with
};

/// Where the blocks of a column begin, by the level that they move. For the loop; work: one unit.
inline const std::uint32_t* column_begin(const FieldColumns& columns, std::uint32_t column) {
  return columns.begin[column_level(column)] + std::size_t{column_place(column)} * columns.levels;
}

/// Blocks of a column that move coefficients of levels 0..field_level. For the loop; work: one unit.
inline std::uint32_t column_blocks(const FieldColumns& columns, std::uint32_t column, std::uint32_t field_level) {
  const std::uint32_t* begin = column_begin(columns, column);
  return begin[field_level + 1] - begin[0];
}

/// Asks the processor for a column.
void prefetch_column(const FieldColumns& columns, std::uint32_t column) noexcept;

/// sums += a column, levels 0..field_level, times a force. For the loop; work: 10 units per block.
void add_column(const FieldColumns& columns, std::uint32_t column, std::uint32_t field_level, Float4 force,
                const SparseCoefficients& sums) noexcept;

/// A stored block by its row's coefficient.
struct MirroredBlock {
  std::uint32_t column;
  std::uint32_t place;  ///< layer, from bit 30 on, and position in its section

  [[nodiscard]] std::uint32_t layer() const { return place >> 30; }
  [[nodiscard]] std::uint32_t position() const { return place & 0x3fffffff; }
};
static_assert(layout::layers <= 4);

/// Where field columns are made.
class FieldColumnMaker {
 public:
  /// Arrays out of `arena`, without the blocks; null while it counts. Start-up; linear in the blocks.
  void carve(Arena& arena, const ModelView& view) noexcept;

  /// Where columns are written, and how much of them at most.
  struct Room {
    ColumnBlock* block = nullptr;  ///< [blocks], or null: they are only counted
    std::uint64_t blocks = 0xffffffff;
    std::uint32_t longest = 0xffffffff;  ///< blocks of one column
  };

  /// How many blocks the columns have.
  struct Counts {
    std::uint64_t blocks = 0;
    std::uint32_t longest = 0;  ///< of one column
    bool finite = true;
    [[nodiscard]] bool within(const Room& room) const {
      return finite && blocks <= room.blocks && longest <= room.longest;
    }
  };

  /// Makes all columns, or stops once they are not within the room. touched: clear; force: [domain], 0; both are so
  /// again afterwards. Start-up; work: about 30 units per block that couples one of a column's coefficients.
  Counts make(const Refinement& refinement, Touched& touched, Float4* force, const Room& room) noexcept;

  [[nodiscard]] const FieldColumns& columns() const { return columns_; }

  /// Finds what read() returns; make does so too. touched: clear, and so again afterwards. Start-up; linear.
  void mark_read(const Refinement& refinement, Touched& touched) noexcept;

  /// [domain] 1 for coefficients that the displacement of a node with layout::node_read depends on, else 0.
  [[nodiscard]] const std::uint8_t* read() const { return read_; }

 private:
  // least square norms of blocks that are kept
  struct Limits {
    double spread_norm = 0;  // of level 0; each level's is four times the one before
    double norm = 0;         // of any level
  };

  void list_mirrored() noexcept;
  void mark_representatives(std::uint32_t c) noexcept;
  double sum_column(const Refinement& refinement, std::uint32_t column, Touched& touched, Float4* force) noexcept;
  [[nodiscard]] Limits limits(const Refinement& refinement, double own) const noexcept;
  void keep_level(std::uint32_t q, const Limits& limits, const Room& room, Counts& counts) noexcept;
  void add_couplings(std::uint32_t coefficient, std::uint32_t level, const Block& force) noexcept;

  const ModelView* view_ = nullptr;
  FieldColumns columns_;
  std::uint32_t* begin_[layout::max_levels] = {};
  std::uint32_t* mirrored_begin_ = nullptr;  // [domain + 1]
  MirroredBlock* mirrored_ = nullptr;
  Block* sum_ = nullptr;            // [domain], 0 between columns
  std::uint8_t* read_ = nullptr;    // [domain]
  std::uint8_t* wanted_ = nullptr;  // [domain] the node at this place stands for a touchable node
};

}  // namespace greenloop
