#include "formats/transport/float_bits.hpp"

#include <algorithm>
#include <bit>

namespace greenloop::transport {
namespace {

constexpr std::uint32_t sign_bit = 0x80000000;
constexpr std::uint32_t hidden_bit = 1U << 23;
constexpr std::uint32_t unit = 40 - 23;  // steps of the last digit of a number with the exponent of reference

}  // namespace

std::uint32_t exponent_of(std::uint32_t bits) { return bits >> 23 & 255; }

std::int64_t to_fixed(std::uint32_t bits, std::uint32_t exponent) {
  const std::uint32_t own = exponent_of(bits);
  const std::uint64_t digits = own == 0 ? bits & (hidden_bit - 1) : (bits & (hidden_bit - 1)) | hidden_bit;
  const std::uint32_t below = exponent - std::min(std::max(own, 1U), exponent);
  const std::uint64_t steps = below > 60 ? 0 : (digits << unit) >> below;
  return (bits & sign_bit) != 0 ? -static_cast<std::int64_t>(steps) : static_cast<std::int64_t>(steps);
}

std::uint32_t from_fixed(std::int64_t fixed, std::uint32_t exponent) {
  const std::uint32_t sign = fixed < 0 ? sign_bit : 0;
  const auto steps = static_cast<std::uint64_t>(fixed < 0 ? -fixed : fixed);
  const auto length = static_cast<std::uint32_t>(std::bit_width(steps));  // 41 with the exponent of reference
  if (length == 0 || exponent + length <= 41) return sign;
  const std::uint64_t digits = length > 24 ? steps >> (length - 24) : steps << (24 - length);
  return sign | (exponent + length - 41) << 23 | (static_cast<std::uint32_t>(digits) & (hidden_bit - 1));
}

std::uint32_t order_of(std::uint32_t bits) { return (bits & sign_bit) != 0 ? ~bits : bits | sign_bit; }

std::uint32_t bits_of_order(std::uint32_t order) { return (order & sign_bit) != 0 ? order & ~sign_bit : ~order; }

}  // namespace greenloop::transport
