#pragma once

#include <cstdint>

namespace greenloop {

// instructions of x86-64, for each contact and tool: from a candidate to a contact and from its answer back
inline constexpr std::uint64_t contact_price = 400;
inline constexpr std::uint64_t tool_price = 300;
inline constexpr std::uint64_t chosen_price = 8;    // a candidate in a pass of choosing
inline constexpr std::uint64_t carried_price = 10;  // a node of a surface that is carried

/// Of choosing candidates that there is room for: a pass for each that lies in a triangle, and one more.
constexpr std::uint64_t most_choosing(std::uint64_t contacts, std::uint64_t points) {
  return (1 + (points < contacts ? points : contacts)) * contacts * chosen_price;
}

}  // namespace greenloop
