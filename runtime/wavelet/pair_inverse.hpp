#pragma once

#include <cstdint>

#include "runtime/algebra/block.hpp"
#include "runtime/wavelet/sparse_inverse.hpp"

namespace greenloop {

/// What two rows of a matrix have in the same column.
template <unsigned N>
struct BlockPair {
  Block<N> row[2];
};

/// T^-1 of two rows of coefficients, the first `steps` of it. x: [slots] what the rows are displaced by per force on
/// each slot, so that blocks apply from the right, transposed. For the loop; work: pair_visit_price a visit.
template <unsigned N>
using InvertPair = void (*)(const SparseInverse& inverse, std::uint32_t steps, BlockPair<N>* x) noexcept;

/// On every processor.
template <unsigned N>
void invert_pair(const SparseInverse& inverse, std::uint32_t steps, BlockPair<N>* x) noexcept;

/// The fastest on this processor, of the same bits. Start-up.
template <unsigned N>
[[nodiscard]] InvertPair<N> fastest_invert_pair() noexcept;
template <>
[[nodiscard]] InvertPair<1> fastest_invert_pair<1>() noexcept;
template <>
[[nodiscard]] InvertPair<3> fastest_invert_pair<3>() noexcept;

}  // namespace greenloop
