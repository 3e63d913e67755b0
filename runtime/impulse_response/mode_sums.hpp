#pragma once

#include <cstdint>

#include "formats/view/impulse_response.hpp"

namespace greenloop {

/// Coordinates as sums over modes take them: whole numbers, so that no sum depends on its order.
struct WholeCoordinates {
  float unit = 0;                    ///< what 1 stands for
  std::uint32_t pairs = 0;           ///< of modes, summed
  std::uint32_t planes = 1;          ///< of the modes' values, summed
  const std::int16_t* of = nullptr;  ///< [2 * pairs], -32767..32767
};

/// Whole coordinates of `pairs` pairs of modes in the unit in which the largest is 32767, into `of`. c: [2 * pairs].
/// For the loop; work: linear in the pairs.
[[nodiscard]] WholeCoordinates whole_coordinates(const float* c, std::uint32_t pairs, std::uint32_t planes,
                                                 std::int16_t* of) noexcept;

/// Displacements of blocks begin..end-1 of 16 vertices by those coordinates (equation 7). values: [48 of each block].
/// avx2: whether the processor has it; the same bits either way. For the loop; work: blocks times pairs.
void sum_modes(const ImpulseResponseView& view, const WholeCoordinates& c, std::uint32_t begin, std::uint32_t end,
               bool avx2, float* values) noexcept;

/// The displacement of one vertex, the same bits as in its block. value: [3]. For the loop; work: pairs.
void sum_modes_at(const ImpulseResponseView& view, const WholeCoordinates& c, std::uint32_t vertex,
                  float* value) noexcept;

}  // namespace greenloop
