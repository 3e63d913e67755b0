#include "offline/scene/fingerprint.hpp"

namespace greenloop::offline {
namespace {

/// value * (2^88 + 0x13b) mod 2^128.
Fingerprint times_prime(Fingerprint value) {
  constexpr std::uint64_t small = 0x13b;
  const std::uint64_t low_half = (value.low & 0xffffffff) * small;
  const std::uint64_t high_half = (value.low >> 32) * small + (low_half >> 32);
  return {.high = value.high * small + (high_half >> 32) + (value.low << 24),
          .low = (high_half << 32) | (low_half & 0xffffffff)};
}

}  // namespace

std::string Fingerprint::hex() const {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const auto half : {high, low}) {
    for (int shift = 60; shift >= 0; shift -= 4) {
      text += digits[(half >> shift) & 15];
    }
  }
  return text;
}

Fingerprint fingerprint(std::string_view bytes, Fingerprint start) {
  for (const char byte : bytes) {
    start.low ^= static_cast<unsigned char>(byte);
    start = times_prime(start);
  }
  return start;
}

}  // namespace greenloop::offline
