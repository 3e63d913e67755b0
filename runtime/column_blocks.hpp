#pragma once

#include <cstdint>

#include "runtime/float4.hpp"
#include "runtime/wavelet.hpp"

namespace greenloop {

/// A block of a field column, m/N.
struct alignas(8) ColumnBlock {
  std::uint32_t byte_offset;  ///< of the moved coefficient in an array of Float4 per domain node
  std::uint16_t value[9];     ///< by columns, upper halves of floats
  std::uint16_t zero;
};

/// Place in the domain of the coefficient that a block moves.
inline std::uint32_t moved_place(const ColumnBlock& block) {
  return block.byte_offset / static_cast<std::uint32_t>(sizeof(Float4));
}

/// sums += the blocks first..last times a force, whose fourth lane is not looked at, one after the other; they are
/// touched. Every one of these functions gives the same bits. For the loop; work: 10 units per block.
using AddBlocks = void (*)(const ColumnBlock* first, const ColumnBlock* last, Float4 force,
                           const SparseCoefficients& sums) noexcept;

/// On every processor.
void add_blocks(const ColumnBlock* first, const ColumnBlock* last, Float4 force,
                const SparseCoefficients& sums) noexcept;

/// The fastest on this processor. Start-up.
[[nodiscard]] AddBlocks fastest_add_blocks() noexcept;

}  // namespace greenloop
