#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "runtime/algebra/block.hpp"

namespace greenloop {

// A stored value of a 3x3 block is moved to the top bits of a 32-bit lane, which needs no sign extension; the power of
// two that this multiplies by is undone, exactly, in the factor that the block is multiplied with.

namespace detail {

/// Where there are no vectors. value(k): stored value k in the top bits of a word.
template <class Value>
Block<3> block_of_values(Value value) {
  const auto number = [&](std::size_t k) { return static_cast<float>(static_cast<std::int32_t>(value(k))); };
  const auto column = [&](std::size_t k) { return Float4{number(k), number(k + 1), number(k + 2), 0.0F}; };
  return {{column(0), column(3), column(6)}};
}

}  // namespace detail

/// Stored N x N blocks of `bits` a value: see layout::CouplingsHeader. Reads at most 16 bytes beyond a block.
template <unsigned N, unsigned bits>
struct StoredBlock;

template <>
struct StoredBlock<3, 4> {
  static constexpr std::size_t bytes = 5;
  static constexpr float widening = 0x1p-28F;
  static Block<3> load(const std::byte* value) {
    std::uint64_t word;
    std::memcpy(&word, value, sizeof word);
    if constexpr (!has_vectors) {
      const std::uint32_t half[2] = {static_cast<std::uint32_t>(word), static_cast<std::uint32_t>(word >> 32)};
      return detail::block_of_values([&](std::size_t k) { return half[k / 8] >> 4 * (k % 8) << 28; });
    }
    // four copies of the nibbles of a column, each shifted until another nibble is on top
    constexpr std::uint64_t copies = 0x0001000100010001;
    constexpr detail::UHalf8 shift = {0x1000, 0x100, 0x10, 1, 0x1000, 0x100, 0x10, 1};
    constexpr detail::UHalf8 top = {0xf000, 0xf000, 0xf000, 0xf000, 0xf000, 0xf000, 0xf000, 0xf000};
    const detail::ULong2 first = {(word & 0xffff) * copies, (word >> 12 & 0xffff) * copies};
    const detail::ULong2 last = {(word >> 24 & 0xffff) * copies, 0};
    const auto two = reinterpret_cast<detail::Half8>(reinterpret_cast<detail::UHalf8>(first) * shift & top);
    const auto one = reinterpret_cast<detail::Half8>(reinterpret_cast<detail::UHalf8>(last) * shift & top);
    return {{detail::low_halves(two), detail::high_halves(two), detail::low_halves(one)}};
  }
};

template <>
struct StoredBlock<3, 8> {
  static constexpr std::size_t bytes = 9;
  static constexpr float widening = detail::byte_widening;
  static Block<3> load(const std::byte* value) {
    if constexpr (!has_vectors) {
      return detail::block_of_values([&](std::size_t k) { return std::to_integer<std::uint32_t>(value[k]) << 24; });
    }
    return {{detail::load_bytes(value), detail::load_bytes(value + 3), detail::load_bytes(value + 6)}};
  }
};

template <>
struct StoredBlock<3, 16> {
  static constexpr std::size_t bytes = 18;
  static constexpr float widening = 0x1p-16F;
  static Block<3> load(const std::byte* value) {
    if constexpr (!has_vectors) {
      return detail::block_of_values([&](std::size_t k) {
        std::uint16_t half;
        std::memcpy(&half, value + sizeof half * k, sizeof half);
        return std::uint32_t{half} << 16;
      });
    }
    return {{detail::load_halves(value), detail::load_halves(value + 6), detail::load_halves(value + 12)}};
  }
};

template <>
struct StoredBlock<1, 4> {
  static constexpr std::size_t bytes = 1;
  static constexpr float widening = 1;
  static Block<1> load(const std::byte* value) {
    const int low = std::to_integer<int>(*value & std::byte{15});
    return {{static_cast<float>((low ^ 8) - 8)}};  // its sign extended
  }
};

template <>
struct StoredBlock<1, 8> {
  static constexpr std::size_t bytes = 1;
  static constexpr float widening = 1;
  static Block<1> load(const std::byte* value) { return {{static_cast<float>(static_cast<std::int8_t>(*value))}}; }
};

template <>
struct StoredBlock<1, 16> {
  static constexpr std::size_t bytes = 2;
  static constexpr float widening = 1;
  static Block<1> load(const std::byte* value) {
    std::int16_t two;
    std::memcpy(&two, value, sizeof two);
    return {{static_cast<float>(two)}};
  }
};

/// Calls visit(StoredBlock of a layer's bits a value).
template <unsigned N, class Visit>
void with_stored(std::uint32_t value_bits, Visit visit) {
  if (value_bits == 4) {
    visit(StoredBlock<N, 4>{});
  } else if (value_bits == 8) {
    visit(StoredBlock<N, 8>{});
  } else {
    visit(StoredBlock<N, 16>{});
  }
}

}  // namespace greenloop
