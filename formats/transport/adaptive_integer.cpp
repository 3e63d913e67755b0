#include "formats/transport/adaptive_integer.hpp"

#include <bit>
#include <cstdlib>

namespace greenloop::transport {
namespace {

constexpr std::uint32_t length_bits = 7;  // of the numbers 0 .. 64
constexpr std::uint32_t one_by_one = 20;
constexpr std::uint32_t longest_rest = 17;

}  // namespace

std::uint32_t quarter_octave(std::uint64_t value) {
  if (value < 4) return static_cast<std::uint32_t>(value);
  const auto top = static_cast<std::uint32_t>(std::bit_width(value)) - 1;
  return 4 * (top - 1) + static_cast<std::uint32_t>(value >> (top - 2) & 3);
}

std::uint32_t half_octave(std::uint64_t value) {
  if (value < 2) return static_cast<std::uint32_t>(value);
  const auto top = static_cast<std::uint32_t>(std::bit_width(value)) - 1;
  return 2 * top + static_cast<std::uint32_t>(value >> (top - 1) & 1);
}

std::uint64_t interleave_sign(std::int64_t value) {
  return static_cast<std::uint64_t>(value) << 1 ^ static_cast<std::uint64_t>(value >> 63);
}

std::int64_t restore_sign(std::uint64_t value) { return static_cast<std::int64_t>(value >> 1 ^ (~(value & 1) + 1)); }

std::uint64_t AdaptiveInteger::code(BitCoder& coder, std::uint64_t value, std::uint32_t context) {
  const auto length = static_cast<std::uint32_t>(std::bit_width(value));
  AdaptiveBit* const tree = &lengths_[std::size_t{context} * 128];
  std::uint32_t node = 1;
  for (std::uint32_t i = length_bits; i-- > 0;) {
    node = 2 * node + static_cast<std::uint32_t>(tree[node].code(coder, (length >> i & 1) != 0));
  }
  const std::uint32_t coded = node - 128;
  if (coded > 64) throw DamagedPacket("an integer of more than 64 binary digits");
  if (coded < 2) return coded;

  AdaptiveBit* const digits = &digits_[(std::size_t{context} * 65 + coded) * 4];
  std::uint64_t result = 1;
  std::uint32_t rest = coded - 1;
  for (node = 1; rest > 0 && node < 4; --rest) {
    const bool digit = digits[node].code(coder, (value >> (rest - 1) & 1) != 0);
    node = 2 * node + static_cast<std::uint32_t>(digit);
    result = result << 1 | static_cast<std::uint64_t>(digit);
  }
  return result << rest | coder.code_plain(value, rest);
}

MixedInteger::MixedInteger(std::span<const std::uint32_t> sizes, std::uint32_t selectors)
    : decisions_(sizes, selectors, 2 + one_by_one + longest_rest) {}

std::int32_t MixedInteger::code(BitCoder& coder, std::int32_t value, std::span<const std::uint32_t> contexts,
                                std::uint32_t selector) {
  auto decide = [&](std::uint32_t decision, bool bit) {
    return decisions_.code(coder, bit, contexts, selector, decision);
  };
  if (!decide(0, value != 0)) return 0;
  const bool negative = decide(1, value < 0);
  const auto wanted = static_cast<std::uint32_t>(std::abs(value));
  std::uint32_t magnitude = 1;
  while (magnitude <= one_by_one && decide(1 + magnitude, wanted > magnitude)) ++magnitude;
  if (magnitude > one_by_one) {
    const std::uint32_t rest = wanted - magnitude + 1;  // from 1
    std::uint32_t length = 0;
    while (decide(2 + one_by_one + length, rest >> (length + 1) != 0)) {
      if (++length == longest_rest) throw DamagedPacket("a value too large for a coupling");
    }
    magnitude += ((1U << length) | static_cast<std::uint32_t>(coder.code_plain(rest, length))) - 1;
  }
  return negative ? -static_cast<std::int32_t>(magnitude) : static_cast<std::int32_t>(magnitude);
}

}  // namespace greenloop::transport
