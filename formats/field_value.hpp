#pragma once

#include <bit>
#include <cstdint>

namespace greenloop {

/// What fields take a stored element of a coupling for, in quanta: the nearest number of 8 significant bits, of two the
/// even one, which is the upper half of a float. An element of 8 bits or fewer is such a number.
inline float field_value(int element) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(element));
  const std::uint32_t half = 0x7fff + (bits >> 16 & 1);
  return std::bit_cast<float>((bits + half) & 0xffff0000);
}

}  // namespace greenloop
