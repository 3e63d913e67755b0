#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace greenloop {

/// Four floats, lane by lane: x y z 0 of a node. Written with the compilers' vector extension, so that the order of
/// operations, and with -ffp-contract=off every bit, is the same on every instruction set.
using Float4 = float __attribute__((vector_size(16)));

inline Float4 splat(float value) { return Float4{value, value, value, value}; }

/// x, y and z; the fourth lane stays 0.
inline Float4 splat3(float value) { return Float4{value, value, value, 0.0F}; }

/// a + b, whose fourth lanes are 0.
inline Float4 sum3(Float4 a, Float4 b) {
#if defined(__SSE2__) || defined(__ARM_NEON)
  return a + b;
#else
  return Float4{a[0] + b[0], a[1] + b[1], a[2] + b[2], 0.0F};
#endif
}

namespace detail {
using Byte16 = std::int8_t __attribute__((vector_size(16)));
using Half8 = std::int16_t __attribute__((vector_size(16)));
using UHalf8 = std::uint16_t __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Long2 = std::int64_t __attribute__((vector_size(16)));
using ULong2 = std::uint64_t __attribute__((vector_size(16)));

inline Float4 low_halves(Half8 halves) {
  const Half8 low = __builtin_shufflevector(Half8{}, halves, 0, 8, 1, 9, 2, 10, 3, 11);
  return __builtin_convertvector(reinterpret_cast<Int4>(low), Float4);
}

inline Float4 high_halves(Half8 halves) {
  const Half8 high = __builtin_shufflevector(Half8{}, halves, 4, 12, 5, 13, 6, 14, 7, 15);
  return __builtin_convertvector(reinterpret_cast<Int4>(high), Float4);
}

inline Float4 load_bytes(const std::byte* value) {
  std::int32_t word;
  std::memcpy(&word, value, sizeof word);
  const auto bytes = reinterpret_cast<Byte16>(Int4{word, 0, 0, 0});
  const Byte16 halves =
      __builtin_shufflevector(Byte16{}, bytes, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  return low_halves(reinterpret_cast<Half8>(halves));
}

inline Float4 load_halves(const std::byte* value) {
  std::int64_t word;
  std::memcpy(&word, value, sizeof word);
  return low_halves(reinterpret_cast<Half8>(Long2{word, 0}));
}

}  // namespace detail

/// Lane by lane 0 where the magnitude is below 2^-90: keeps denormal numbers out of the sums.
inline Float4 without_denormals(Float4 value) {
#if !defined(__SSE2__) && !defined(__ARM_NEON)
  const auto kept = [](float lane) {
    const auto bits = std::bit_cast<std::uint32_t>(lane);
    return (bits & 0x7fffffff) < std::bit_cast<std::uint32_t>(0x1p-90F) ? 0.0F : lane;
  };
  return Float4{kept(value[0]), kept(value[1]), kept(value[2]), kept(value[3])};
#else
  const Float4 least = splat(0x1p-90F);
  const detail::Int4 tiny = (value < least) & (value > -least);
  return reinterpret_cast<Float4>(reinterpret_cast<detail::Int4>(value) & ~tiny);
#endif
}

/// The same with a fourth lane of 0.
inline Float4 xyz(Float4 value) {
  return reinterpret_cast<Float4>(reinterpret_cast<detail::Int4>(value) & detail::Int4{-1, -1, -1, 0});
}

/// A 3x3 block by columns; fourth lanes undefined.
struct Block {
  Float4 column[3];
};

inline Block transposed(const Block& m) {
  const Float4 low = __builtin_shufflevector(m.column[0], m.column[1], 0, 4, 1, 5);
  const Float4 high = __builtin_shufflevector(m.column[0], m.column[1], 2, 6, 3, 7);
  return {{__builtin_shufflevector(low, m.column[2], 0, 1, 4, 7), __builtin_shufflevector(low, m.column[2], 2, 3, 5, 7),
           __builtin_shufflevector(high, m.column[2], 0, 1, 6, 7)}};
}

/// block times vector: the fourth lane is 0 if that of `f` is.
inline Float4 product(const Block& m, const Float4 (&f)[3]) {
  return (m.column[0] * f[0] + m.column[1] * f[1]) + m.column[2] * f[2];
}

/// A symmetric matrix xx, xy, xz, yy, yz, zz as a block with fourth lanes of 0.
inline Block symmetric_block(const float (&matrix)[6]) {
  Float4 low;
  Float4 high;
  std::memcpy(&low, matrix, sizeof low);
  std::memcpy(&high, matrix + 2, sizeof high);
  return {{xyz(low), xyz(__builtin_shufflevector(low, high, 1, 3, 6, 6)),
           xyz(__builtin_shufflevector(high, high, 0, 2, 3, 3))}};
}

/// block times vector: the fourth lane is 0 if those of the block are.
inline Float4 product(const Block& m, Float4 x) {
  const Float4 splats[3] = {splat(x[0]), splat(x[1]), splat(x[2])};
  return product(m, splats);
}

/// Transposed block times vector: the fourth lane is 0 if that of `x` is.
inline Float4 transposed_product(const Block& m, Float4 x) {
  const Block rows = transposed({{m.column[0] * x, m.column[1] * x, m.column[2] * x}});
  return (rows.column[0] + rows.column[1]) + rows.column[2];
}

/// A symmetric matrix xx, xy, xz, yy, yz, zz times a vector; the fourth lane is 0.
inline Float4 symmetric_product(const float (&matrix)[6], Float4 x) {
#if defined(__SSE2__) || defined(__ARM_NEON)
  Float4 low;
  Float4 high;
  std::memcpy(&low, matrix, sizeof low);
  std::memcpy(&high, matrix + 2, sizeof high);
  const Float4 second = __builtin_shufflevector(low, high, 1, 3, 6, 6);
  const Float4 third = __builtin_shufflevector(high, high, 0, 2, 3, 3);
  return xyz((low * splat(x[0]) + second * splat(x[1])) + third * splat(x[2]));
#else
  const auto row = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (matrix[a] * x[0] + matrix[b] * x[1]) + matrix[c] * x[2];
  };
  return Float4{row(0, 1, 2), row(1, 3, 4), row(2, 4, 5), 0.0F};
#endif
}

/// Each element of a block in all lanes.
struct BlockSplats {
  Float4 column[3][3];
};

inline BlockSplats splats(const Block& m) {
  BlockSplats result;
  for (std::size_t k = 0; k < 9; ++k) {
    result.column[k / 3][k % 3] = splat(m.column[k / 3][k % 3]);
  }
  return result;
}

/// Product of two blocks: fourth lanes are 0 if those of `a` are.
inline Block product(const Block& a, const BlockSplats& b) {
  return {{product(a, b.column[0]), product(a, b.column[1]), product(a, b.column[2])}};
}

/// Product of two blocks: fourth lanes are 0 if those of `a` are.
inline Block product(const Block& a, const Block& b) {
  return {{product(a, b.column[0]), product(a, b.column[1]), product(a, b.column[2])}};
}

// A stored value is moved to the top bits of a 32-bit lane, which needs no sign extension; the power of two that this
// multiplies by is undone, exactly, in the factor that the block is multiplied with.

/// Stored blocks of `bits` a value: see layout::CouplingsHeader. Reads at most 16 bytes beyond a block.
template <unsigned bits>
struct StoredBlock;

template <>
struct StoredBlock<4> {
  static constexpr std::size_t bytes = 5;
  static constexpr float widening = 0x1p-28F;
  static Block load(const std::byte* value) {
    std::uint64_t word;
    std::memcpy(&word, value, sizeof word);
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
struct StoredBlock<8> {
  static constexpr std::size_t bytes = 9;
  static constexpr float widening = 0x1p-24F;
  static Block load(const std::byte* value) {
    return {{detail::load_bytes(value), detail::load_bytes(value + 3), detail::load_bytes(value + 6)}};
  }
};

template <>
struct StoredBlock<16> {
  static constexpr std::size_t bytes = 18;
  static constexpr float widening = 0x1p-16F;
  static Block load(const std::byte* value) {
    return {{detail::load_halves(value), detail::load_halves(value + 6), detail::load_halves(value + 12)}};
  }
};

}  // namespace greenloop
