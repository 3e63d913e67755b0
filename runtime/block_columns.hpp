#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

// Kernels over one block-sparse column: wavelet coefficients of the displacement per force at that column.

/// Blocks of a column in the rows of levels 0..row_level. Work: one unit per level.
[[nodiscard]] std::uint32_t column_blocks(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column,
                                          std::uint32_t row_level) noexcept;

/// Asks for the memory of a column that add_column or scatter_column will soon read; changes no result. For the loop;
/// work: a hint per cache line of the column.
void prefetch_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column,
                     std::uint32_t row_level) noexcept;

/// x += column times force, in the rows of levels 0..row_level (step 5 of fast summation, James & Pai 2003, section
/// 5.4). x: [node_count], by file node. For the loop; work: 9 units per block.
void add_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column, const float (&force)[3],
                std::uint32_t row_level, Float4* x) noexcept;

/// A 3x3 block by columns; m/N.
struct Block {
  Float4 column[3];  ///< fourth lanes undefined
};

/// blocks[node] = the column's block there, nothing elsewhere. For the loop; work: 9 units per block.
void scatter_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column,
                    Block* blocks) noexcept;

/// Zeroes what scatter_column wrote. For the loop; work: 3 units per block.
void clear_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column, Block* blocks) noexcept;

}  // namespace greenloop
