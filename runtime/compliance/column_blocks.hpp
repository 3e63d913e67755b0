#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/float4.hpp"

namespace greenloop {

/// Consecutive blocks of a couplings section, in place.
struct BlockRange {
  const CouplingsView* couplings = nullptr;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// sums[row] += block * force for the blocks of a range, one after the other. force: block_factor included; its fourth
/// lane is 0. For the loop; work: block_work units per block.
using AddBlocks = void (*)(const BlockRange& range, Float4 force, Float4* sums) noexcept;

/// Work units of a block in a sum.
inline constexpr std::uint64_t block_work = 12;

/// One for each layer of couplings. All of these give the same bits.
struct BlockSums {
  AddBlocks add[layout::layers];
};

/// On every processor.
[[nodiscard]] BlockSums portable_block_sums() noexcept;

/// The fastest on this processor. Start-up.
[[nodiscard]] BlockSums fastest_block_sums() noexcept;

}  // namespace greenloop
