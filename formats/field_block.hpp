#pragma once

#include <bit>
#include <cstdint>

#include "formats/layout.hpp"

namespace greenloop {

/// Element (r, c) of a symmetric matrix xx, xy, xz, yy, yz, zz.
constexpr float symmetric_element(const float (&six)[6], std::uint32_t r, std::uint32_t c) {
  constexpr std::uint32_t place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  return six[place[r][c]];
}

/// The nearest number of 8 significant bits, of two the even one: the upper half of a float.
inline float upper_half(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>((bits + (0x7fff + (bits >> 16 & 1))) & 0xffff0000);
}

/// Upper halves that a number of a field's block is the sum of: 8 significant bits each. Where couplings are so large
/// that they need the first layer's coarser quantum, they cancel, and 8 bits are too few.
inline std::uint32_t field_halves(const layout::Info& info) { return info.quantum[0] > info.quantum[1] ? 2 : 1; }

/// The sum of that many upper halves nearest to a value.
inline float rounded_for_fields(float value, std::uint32_t halves) {
  const float half = upper_half(value);
  return halves == 1 ? half : half + upper_half(value - half);
}

/// What fields take a stored coupling for, before it is rounded: 9 numbers 3 c + r of R_i M R_j (m/N), M in quanta, in
/// single precision. element(k): element k of the stored block.
template <class Element>
void field_block(const layout::Scale& row, const layout::Scale& column, float quantum, Element element,
                 float (&block)[9]) {
  float product[9];  // M R_j
  for (std::uint32_t c = 0; c < 3; ++c) {
    for (std::uint32_t r = 0; r < 3; ++r) {
      float sum = 0;
      for (std::uint32_t k = 0; k < 3; ++k) {
        sum += quantum * static_cast<float>(element(3 * k + r)) * symmetric_element(column.root, k, c);
      }
      product[3 * c + r] = sum;
    }
  }
  for (std::uint32_t c = 0; c < 3; ++c) {
    for (std::uint32_t r = 0; r < 3; ++r) {
      float sum = 0;
      for (std::uint32_t k = 0; k < 3; ++k) {
        sum += symmetric_element(row.root, r, k) * product[3 * c + k];
      }
      block[3 * c + r] = sum;
    }
  }
}

}  // namespace greenloop
