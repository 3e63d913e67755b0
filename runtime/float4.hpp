#pragma once

#include <cstdint>
#include <cstring>

namespace greenloop {

/// Four floats, lane by lane: x y z 0 of a node. Written with the compilers' vector extension, so that the order of
/// operations, and with -ffp-contract=off every bit, is the same on every instruction set.
using Float4 = float __attribute__((vector_size(16)));

inline Float4 splat(float value) { return Float4{value, value, value, value}; }

/// x, y and z; the fourth lane stays 0.
inline Float4 splat3(float value) { return Float4{value, value, value, 0.0F}; }

// A stored value is moved to the top bits of a 32-bit lane, which needs no sign extension; the power of two that this
// multiplies by is undone, exactly, in the factor that the block is multiplied with.
template <class Value>
inline constexpr float widening = 0;
template <>
inline constexpr float widening<std::int8_t> = 0x1p-24F;
template <>
inline constexpr float widening<std::int16_t> = 0x1p-16F;

namespace detail {
using Byte16 = std::int8_t __attribute__((vector_size(16)));
using Half8 = std::int16_t __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Long2 = std::int64_t __attribute__((vector_size(16)));

inline Float4 top_halves(Half8 halves) {
  const Half8 low = __builtin_shufflevector(Half8{}, halves, 0, 8, 1, 9, 2, 10, 3, 11);
  return __builtin_convertvector(reinterpret_cast<Int4>(low), Float4);
}
}  // namespace detail

/// The four values at `value`, each times 1 / widening. Reads one value beyond a block's column.
inline Float4 load_widened(const std::int8_t* value) {
  std::int32_t word;
  std::memcpy(&word, value, sizeof word);
  const auto bytes = reinterpret_cast<detail::Byte16>(detail::Int4{word, 0, 0, 0});
  const detail::Byte16 halves =
      __builtin_shufflevector(detail::Byte16{}, bytes, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  return detail::top_halves(reinterpret_cast<detail::Half8>(halves));
}

inline Float4 load_widened(const std::int16_t* value) {
  std::int64_t word;
  std::memcpy(&word, value, sizeof word);
  return detail::top_halves(reinterpret_cast<detail::Half8>(detail::Long2{word, 0}));
}

}  // namespace greenloop
