#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/transport/adaptive_bit.hpp"

namespace greenloop::transport {

/// Steps of a logarithmic scale: 0 .. 3 for themselves, then four a doubling; 251 at most.
[[nodiscard]] std::uint32_t quarter_octave(std::uint64_t value);

/// The same with two a doubling from 2 on; 127 at most.
[[nodiscard]] std::uint32_t half_octave(std::uint64_t value);

/// 0, -1, 1, -2, .. to 0, 1, 2, 3, .. and back.
[[nodiscard]] std::uint64_t interleave_sign(std::int64_t value);
[[nodiscard]] std::int64_t restore_sign(std::uint64_t value);

/// Integers of any size in the manner of Elias and Golomb: the number of binary digits, learned; the two digits after
/// the first, learned; the others as they are.
class AdaptiveInteger {
 public:
  explicit AdaptiveInteger(std::uint32_t contexts)
      : lengths_(std::size_t{contexts} * 128), digits_(std::size_t{contexts} * 65 * 4) {}

  /// context < contexts.
  std::uint64_t code(BitCoder& coder, std::uint64_t value, std::uint32_t context);

 private:
  std::vector<AdaptiveBit> lengths_;  // [contexts][node of a binary tree over 0 .. 64]
  std::vector<AdaptiveBit> digits_;   // [contexts][length][node of a binary tree over two digits]
};

/// Small signed integers from several contexts at once: whether it is zero, its sign, then its magnitude one by one,
/// from 20 on in the manner of Elias. Magnitudes up to 2^17.
class MixedInteger {
 public:
  MixedInteger(std::span<const std::uint32_t> sizes, std::uint32_t selectors);

  /// As MixedBits::code. Throws DamagedPacket if the magnitude read is larger than any that is written.
  std::int32_t code(BitCoder& coder, std::int32_t value, std::span<const std::uint32_t> contexts,
                    std::uint32_t selector);

 private:
  MixedBits decisions_;
};

}  // namespace greenloop::transport
