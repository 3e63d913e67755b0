#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace greenloop {

/// Four floats, lane by lane. Written with the compilers' vector extension, so that the order of operations, and with
/// -ffp-contract=off every bit, is the same on every instruction set.
using Float4 = float __attribute__((vector_size(16)));

/// Whether the target has vectors of four floats. Where it has none, lanes that nobody reads are left out.
#if defined(__SSE2__) || defined(__ARM_NEON)
inline constexpr bool has_vectors = true;
#else
inline constexpr bool has_vectors = false;
#endif

inline Float4 splat(float value) { return Float4{value, value, value, value}; }

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

/// What four values of load_bytes are to be multiplied with.
inline constexpr float byte_widening = 0x1p-24F;

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

inline float without_denormals(float value) {
  // no branch on data: the same instructions for every number
  const std::uint32_t tiny =
      static_cast<std::uint32_t>(value < 0x1p-90F) & static_cast<std::uint32_t>(value > -0x1p-90F);
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & (tiny - 1));
}

/// With a fourth lane of 0.
inline Float4 xyz(Float4 value) {
  return reinterpret_cast<Float4>(reinterpret_cast<detail::Int4>(value) & detail::Int4{-1, -1, -1, 0});
}

}  // namespace greenloop
