#include "runtime/impulse_response/appearance.hpp"

#include <cstddef>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace greenloop {
namespace {

using layout::block_vertices;
using layout::colours;
using layout::light_coefficients;
using layout::transfer_mode_pairs;

constexpr std::size_t pair_bytes = std::size_t{2} * block_vertices;

float size_of(float x) { return x < 0 ? -x : x; }

float largest_of(const float* values, std::uint32_t count, float largest) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const float size = size_of(values[i]);
    largest = size > largest ? size : largest;
  }
  return largest;
}

float largest_of(const Light& light) {
  float largest = largest_of(light.red, light_coefficients, 0);
  largest = largest_of(light.green, light_coefficients, largest);
  return largest_of(light.blue, light_coefficients, largest);
}

// numbers of a light times a factor, in the unit in which `largest` is 32767
void round_light(const float* light, float factor, float largest, std::int16_t* of) {
  constexpr float most = layout::most_coordinate;
  const float per_unit = largest > 0 ? most / largest : 0;
  for (std::uint32_t i = 0; i < light_coefficients; ++i) {
    const float x = light[i] * factor * per_unit;
    const float rounded = x + (x < 0 ? -0.5F : 0.5F);
    of[i] = static_cast<std::int16_t>(rounded > most ? most : rounded < -most ? -most : rounded);
  }
}

const std::int8_t* transfers_of(const ImpulseResponseView& view, std::uint32_t block, std::uint32_t colour) {
  return view.appearance.transfers +
         (std::size_t{colours} * block + colour) * layout::transfer_bytes(view.appearance.modes);
}

const std::int16_t* numbers_of(const LitState& lit, std::uint32_t colour) {
  return lit.of + std::size_t{light_coefficients} * (1 + lit.modes) * colour;
}

// what is summed apart: the two planes of the mean, and modes
constexpr std::uint32_t parts = 3;
constexpr float plane_weight = 256;

// calls add(part, bytes of the first pair, numbers, pairs) for each
template <class Add>
void visit_parts(const ImpulseResponseView& view, const LitState& lit, std::uint32_t block, std::uint32_t colour,
                 Add add) {
  const std::int8_t* const at = transfers_of(view, block, colour);
  const std::int16_t* const numbers = numbers_of(lit, colour);
  add(0, at, numbers, transfer_mode_pairs);
  add(1, at + pair_bytes * transfer_mode_pairs, numbers, transfer_mode_pairs);
  add(2, at + 2 * pair_bytes * transfer_mode_pairs, numbers + light_coefficients, transfer_mode_pairs * lit.modes);
}

float value_of(const ImpulseResponseView& view, const LitState& lit, std::uint32_t block, std::int32_t high,
               std::int32_t low, std::int32_t of_modes) {
  const float* const quantum = view.appearance.quanta + std::size_t{2} * block;
  const float mean = static_cast<float>(high) * plane_weight + static_cast<float>(low);
  return mean * (quantum[0] * lit.unit[0]) + static_cast<float>(of_modes) * (quantum[1] * lit.unit[1]);
}

// once, not in every part: what it keeps in registers and on the stack is much
[[gnu::noinline]] void add_pairs(const std::int8_t* values, const std::int16_t* numbers, std::uint32_t pairs,
                                 std::int32_t* sums) {
  for (std::uint32_t p = 0; p < pairs; ++p, values += pair_bytes) {
    const std::int32_t first = numbers[std::size_t{2} * p], second = numbers[std::size_t{2} * p + 1];
    for (std::uint32_t v = 0; v < block_vertices; ++v)
      sums[v] += values[std::size_t{2} * v] * first + values[std::size_t{2} * v + 1] * second;
  }
}

// the same of one vertex, whose first value is the first of these
std::int32_t sum_pairs(const std::int8_t* values, const std::int16_t* numbers, std::uint32_t pairs) {
  std::int32_t sum = 0;
  for (const std::int16_t* const end = numbers + std::size_t{2} * pairs; numbers < end;
       numbers += 2, values += pair_bytes)
    sum += values[0] * numbers[0] + values[1] * numbers[1];
  return sum;
}

// one colour of a block's vertices
void sum_colour(const ImpulseResponseView& view, const LitState& lit, std::uint32_t block, std::uint32_t colour,
                float (&values)[block_vertices]) {
  std::int32_t sums[parts][block_vertices] = {};
  visit_parts(view, lit, block, colour,
              [&](std::uint32_t part, const std::int8_t* at, const std::int16_t* numbers, std::uint32_t pairs) {
                add_pairs(at, numbers, pairs, sums[part]);
              });
  for (std::uint32_t v = 0; v < block_vertices; ++v)
    values[v] = value_of(view, lit, block, sums[0][v], sums[1][v], sums[2][v]);
}

#if defined(__x86_64__)
/// Sums of eight vertices each.
struct TwoSums {
  __m256i of[2];
};

[[gnu::target("avx2")]] inline TwoSums sum_pairs_avx2(const std::int8_t* values, const std::int16_t* numbers,
                                                      std::uint32_t pairs) noexcept {
  TwoSums sums = {{_mm256_setzero_si256(), _mm256_setzero_si256()}};
  for (std::uint32_t p = 0; p < pairs; ++p, values += pair_bytes) {
    std::int32_t both;
    __builtin_memcpy(&both, numbers + std::size_t{2} * p, sizeof both);
    const __m256i factor = _mm256_set1_epi32(both);
#pragma GCC unroll 2
    for (std::uint32_t k = 0; k < 2; ++k) {
      const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(values + std::size_t{16} * k));
      sums.of[k] = _mm256_add_epi32(sums.of[k], _mm256_madd_epi16(_mm256_cvtepi8_epi16(bytes), factor));
    }
  }
  return sums;
}

[[gnu::target("avx2")]] void sum_colour_avx2(const ImpulseResponseView& view, const LitState& lit, std::uint32_t block,
                                             std::uint32_t colour, float (&values)[block_vertices]) {
  const std::int8_t* const at = transfers_of(view, block, colour);
  const std::int16_t* const numbers = numbers_of(lit, colour);
  const TwoSums high = sum_pairs_avx2(at, numbers, transfer_mode_pairs);
  const TwoSums low = sum_pairs_avx2(at + pair_bytes * transfer_mode_pairs, numbers, transfer_mode_pairs);
  const TwoSums of_modes = sum_pairs_avx2(at + 2 * pair_bytes * transfer_mode_pairs, numbers + light_coefficients,
                                          transfer_mode_pairs * lit.modes);
  const float* const quantum = view.appearance.quanta + std::size_t{2} * block;
  const __m256 mean_scale = _mm256_set1_ps(quantum[0] * lit.unit[0]);
  const __m256 mode_scale = _mm256_set1_ps(quantum[1] * lit.unit[1]);
  for (std::uint32_t k = 0; k < 2; ++k) {
    const __m256 mean = _mm256_add_ps(_mm256_mul_ps(_mm256_cvtepi32_ps(high.of[k]), _mm256_set1_ps(plane_weight)),
                                      _mm256_cvtepi32_ps(low.of[k]));
    const __m256 modes = _mm256_mul_ps(_mm256_cvtepi32_ps(of_modes.of[k]), mode_scale);
    _mm256_storeu_ps(values + std::size_t{8} * k, _mm256_add_ps(_mm256_mul_ps(mean, mean_scale), modes));
  }
}
#endif

}  // namespace

bool is_light(const Light& light) noexcept {
  constexpr float most = 0x1p+64F;
  const auto fits = [](const float(&of)[light_coefficients]) {
    for (const float x : of) {
      if (!(size_of(x) <= most)) return false;
    }
    return true;
  };
  return fits(light.red) && fits(light.green) && fits(light.blue);
}

LitState lit_state(const Light& light, const float* coordinates, std::uint32_t modes, std::int16_t* of) noexcept {
  constexpr float most = layout::most_coordinate;
  constexpr float least = 1e-30F;  // its reciprocal is finite; what is darker is black
  const float bright = largest_of(light), largest = bright < least ? 0 : bright;
  const float product = largest * largest_of(coordinates, modes, 0), largest_product = product < least ? 0 : product;
  for (const float* const colour : {light.red, light.green, light.blue}) {
    round_light(colour, 1, largest, of);
    of += light_coefficients;
    for (std::uint32_t m = 0; m < modes; ++m, of += light_coefficients)
      round_light(colour, coordinates[m], largest_product, of);
  }
  return {{largest / most, largest_product / most}, modes, of - lit_numbers(modes)};
}

void sum_colours(const ImpulseResponseView& view, const LitState& lit, std::uint32_t count, bool avx2,
                 Vec3* colour) noexcept {
  for (std::uint32_t block = 0; block * block_vertices < count; ++block) {
    float values[colours][block_vertices];
    for (std::uint32_t c = 0; c < colours; ++c) {
#if defined(__x86_64__)
      if (avx2) {
        sum_colour_avx2(view, lit, block, c, values[c]);
        continue;
      }
#endif
      sum_colour(view, lit, block, c, values[c]);
    }
    const std::uint32_t left = count - block * block_vertices;
    for (std::uint32_t v = 0; v < (left < block_vertices ? left : block_vertices); ++v)
      *colour++ = {values[0][v], values[1][v], values[2][v]};
  }
  static_cast<void>(avx2);
}

Vec3 colour_at(const ImpulseResponseView& view, const LitState& lit, std::uint32_t vertex) noexcept {
  const std::uint32_t block = vertex / block_vertices;
  const std::size_t place = std::size_t{2} * (vertex % block_vertices);
  float value[colours];
  for (std::uint32_t c = 0; c < colours; ++c) {
    std::int32_t sums[parts] = {};
    visit_parts(view, lit, block, c,
                [&](std::uint32_t part, const std::int8_t* at, const std::int16_t* numbers, std::uint32_t pairs) {
                  sums[part] = sum_pairs(at + place, numbers, pairs);
                });
    value[c] = value_of(view, lit, block, sums[0], sums[1], sums[2]);
  }
  return {value[0], value[1], value[2]};
}

}  // namespace greenloop
