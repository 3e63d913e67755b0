#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"

namespace greenloop {

/// Consecutive blocks of a couplings section, in place.
struct BlockRange {
  const CouplingsView* couplings = nullptr;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// sums[row] += block * force for the blocks of a range, one after the other. force: block_factor included; its fourth
/// lane is 0. For the loop; work: block_work units per block.
template <unsigned N>
using AddBlocks = void (*)(const BlockRange& range, Vector<N> force, Vector<N>* sums) noexcept;

/// Work units of a block in a sum: its elements, and where it stands.
template <unsigned N>
inline constexpr std::uint64_t block_work = std::uint64_t{N} * (N + 1);

/// One for each layer of couplings. All of these give the same bits.
template <unsigned N>
struct BlockSums {
  AddBlocks<N> add[layout::layers];
};

/// On every processor.
template <unsigned N>
[[nodiscard]] BlockSums<N> portable_block_sums() noexcept;

/// The fastest on this processor. Start-up.
template <unsigned N>
[[nodiscard]] BlockSums<N> fastest_block_sums() noexcept;
template <>
[[nodiscard]] BlockSums<1> fastest_block_sums<1>() noexcept;
template <>
[[nodiscard]] BlockSums<3> fastest_block_sums<3>() noexcept;

}  // namespace greenloop
