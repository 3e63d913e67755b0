#pragma once

// Single-precision numbers by their binary digits: exact integer arithmetic, the same on every machine.

#include <cstdint>

namespace greenloop::transport {

/// The biased exponent of a number, 0 .. 255.
[[nodiscard]] std::uint32_t exponent_of(std::uint32_t bits);

/// The number in steps of 2^(exponent - 127 - 40), towards zero, where `exponent` is a biased one; numbers with larger
/// exponents as if they had this one. Below 2^41 in magnitude.
[[nodiscard]] std::int64_t to_fixed(std::uint32_t bits, std::uint32_t exponent);

/// Back, the digits that have no place cut off.
[[nodiscard]] std::uint32_t from_fixed(std::int64_t fixed, std::uint32_t exponent);

/// Whole numbers in the order of the numbers: neighbours differ by 1. A bijection of all 2^32 patterns.
[[nodiscard]] std::uint32_t order_of(std::uint32_t bits);
[[nodiscard]] std::uint32_t bits_of_order(std::uint32_t order);

}  // namespace greenloop::transport
