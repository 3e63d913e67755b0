#pragma once

#include <cstdint>

#include "formats/view/impulse_response.hpp"
#include "runtime/light.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

/// Light on a state, as sums of transfers take it: whole numbers, so that no sum depends on its order.
struct LitState {
  float unit[2] = {};                ///< what 1 stands for, of the mean transfer and of its modes
  std::uint32_t modes = 0;           ///< summed
  const std::int16_t* of = nullptr;  ///< [3][16 (1 + modes)], -32767..32767: light, then light times each coordinate
};

/// Numbers that such a state takes.
constexpr std::uint32_t lit_numbers(std::uint32_t modes) {
  return layout::colours * layout::light_coefficients * (1 + modes);
}

/// Whether a light can be summed: its coefficients are finite and at most 2^64.
[[nodiscard]] bool is_light(const Light& light) noexcept;

/// A light on the state with these transfer coordinates, into `of`, [lit_numbers(modes)], in units in which the largest
/// number is 32767. For the loop; work: linear in the modes.
[[nodiscard]] LitState lit_state(const Light& light, const float* coordinates, std::uint32_t modes,
                                 std::int16_t* of) noexcept;

/// Exit radiance of `count` vertices from the first of a block on, red, green and blue (James & Fatahalian 2003,
/// section 4.1). avx2: whether the processor has it; the same bits either way. For the loop; work: blocks of 16 times
/// modes.
void sum_colours(const ImpulseResponseView& view, const LitState& lit, std::uint32_t count, bool avx2,
                 Vec3* colour) noexcept;

/// That of one vertex, the same bits. For the loop; work: modes.
[[nodiscard]] Vec3 colour_at(const ImpulseResponseView& view, const LitState& lit, std::uint32_t vertex) noexcept;

}  // namespace greenloop
