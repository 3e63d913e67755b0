#include "runtime/impulse_response/mode_sums.hpp"

#include <cstddef>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace greenloop {
namespace {

using layout::block_values;

constexpr float plane_weight = 256;
constexpr std::size_t pair_bytes = std::size_t{2} * block_values;

// The sums of a block: of the first plane, and of the second.
struct BlockSums {
  std::int32_t high[block_values];
  std::int32_t low[block_values];
};

// m that 1 of a block's sums stands for; where the second of two planes is left out, the first stands for both
float scale_of(const ImpulseResponseView& view, const WholeCoordinates& c, std::uint32_t block) {
  return view.quanta[block] * c.unit * (c.planes < view.info->planes ? plane_weight : 1.0F);
}

float value_of(std::int32_t high, std::int32_t low, std::uint32_t planes, float scale) {
  const auto first = static_cast<float>(high);
  return (planes == 1 ? first : first * plane_weight + static_cast<float>(low)) * scale;
}

// Calls add(bytes of the group's first pair, its coordinates, pairs) for each group in the sum, of a plane and block.
template <class Add>
void visit_groups(const ImpulseResponseView& view, const WholeCoordinates& c, std::uint32_t plane, std::uint32_t block,
                  Add add) {
  std::uint32_t left = c.pairs;
  const std::int16_t* at = c.of;
  for (std::uint32_t q = 0; left > 0; ++q) {
    const std::uint32_t pairs = view.group[q].counts->modes / 2;
    const std::uint32_t summed = pairs < left ? pairs : left;
    add(view.group[q].plane[plane] + pair_bytes * pairs * block, at, summed);
    at += std::size_t{2} * summed;
    left -= summed;
  }
}

void add_pairs(const std::int8_t* values, const std::int16_t* c, std::uint32_t pairs, std::int32_t* sums) noexcept {
  for (std::uint32_t p = 0; p < pairs; ++p, values += pair_bytes) {
    const std::int32_t first = c[std::size_t{2} * p], second = c[std::size_t{2} * p + 1];
    for (std::uint32_t v = 0; v < block_values; ++v)
      sums[v] += values[std::size_t{2} * v] * first + values[std::size_t{2} * v + 1] * second;
  }
}

void sum_block(const ImpulseResponseView& view, const WholeCoordinates& c, std::uint32_t block, float* values) {
  BlockSums sums{};
  for (std::uint32_t plane = 0; plane < c.planes; ++plane) {
    std::int32_t* const of_plane = plane == 0 ? sums.high : sums.low;
    visit_groups(view, c, plane, block, [&](const std::int8_t* at, const std::int16_t* of, std::uint32_t pairs) {
      add_pairs(at, of, pairs, of_plane);
    });
  }
  const float scale = scale_of(view, c, block);
  for (std::uint32_t v = 0; v < block_values; ++v) values[v] = value_of(sums.high[v], sums.low[v], c.planes, scale);
}

#if defined(__x86_64__)
constexpr std::uint32_t vectors = block_values / 8;

/// The sums of a block and a plane, in registers.
struct PlaneSums {
  __m256i of[vectors];
};

[[gnu::target("avx2")]] inline PlaneSums add_pairs_avx2(const std::int8_t* values, const std::int16_t* c,
                                                        std::uint32_t pairs, PlaneSums sums) noexcept {
  for (std::uint32_t p = 0; p < pairs; ++p, values += pair_bytes) {
    std::int32_t both;
    __builtin_memcpy(&both, c + std::size_t{2} * p, sizeof both);
    const __m256i factor = _mm256_set1_epi32(both);
#pragma GCC unroll 6
    for (std::uint32_t k = 0; k < vectors; ++k) {
      const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(values + std::size_t{16} * k));
      sums.of[k] = _mm256_add_epi32(sums.of[k], _mm256_madd_epi16(_mm256_cvtepi8_epi16(bytes), factor));
    }
  }
  return sums;
}

[[gnu::target("avx2")]] inline PlaneSums sum_plane_avx2(const ImpulseResponseView& view, const WholeCoordinates& c,
                                                        std::uint32_t plane, std::uint32_t block) {
  PlaneSums sums;
  for (auto& sum : sums.of) sum = _mm256_setzero_si256();
  std::uint32_t left = c.pairs;
  const std::int16_t* at = c.of;
  for (std::uint32_t q = 0; left > 0; ++q) {
    const std::uint32_t pairs = view.group[q].counts->modes / 2;
    const std::uint32_t summed = pairs < left ? pairs : left;
    sums = add_pairs_avx2(view.group[q].plane[plane] + pair_bytes * pairs * block, at, summed, sums);
    at += std::size_t{2} * summed;
    left -= summed;
  }
  return sums;
}

[[gnu::target("avx2")]] void sum_block_avx2(const ImpulseResponseView& view, const WholeCoordinates& c,
                                            std::uint32_t block, float* values) {
  const PlaneSums high = sum_plane_avx2(view, c, 0, block);
  const PlaneSums low = c.planes == 2 ? sum_plane_avx2(view, c, 1, block) : high;
  const __m256 scale = _mm256_set1_ps(scale_of(view, c, block));
  for (std::uint32_t k = 0; k < vectors; ++k) {
    __m256 value = _mm256_cvtepi32_ps(high.of[k]);
    if (c.planes == 2) {
      value = _mm256_add_ps(_mm256_mul_ps(value, _mm256_set1_ps(plane_weight)), _mm256_cvtepi32_ps(low.of[k]));
    }
    _mm256_storeu_ps(values + std::size_t{8} * k, _mm256_mul_ps(value, scale));
  }
}
#endif

}  // namespace

WholeCoordinates whole_coordinates(const float* c, std::uint32_t pairs, std::uint32_t planes,
                                   std::int16_t* of) noexcept {
  float largest = 0;
  for (std::uint32_t m = 0; m < 2 * pairs; ++m) {
    const float size = c[m] < 0 ? -c[m] : c[m];
    largest = size > largest ? size : largest;
  }
  constexpr float most = layout::most_coordinate;
  constexpr float least = 1e-30F;  // its reciprocal is finite
  if (largest < least) largest = 0;
  const float per_unit = largest > 0 ? most / largest : 0;
  for (std::uint32_t m = 0; m < 2 * pairs; ++m) {
    const float x = c[m] * per_unit;
    const float rounded = x + (x < 0 ? -0.5F : 0.5F);
    of[m] = static_cast<std::int16_t>(rounded > most ? most : rounded < -most ? -most : rounded);
  }
  return {largest / most, pairs, planes, of};
}

void sum_modes(const ImpulseResponseView& view, const WholeCoordinates& c, std::uint32_t begin, std::uint32_t end,
               bool avx2, float* values) noexcept {
  for (std::uint32_t block = begin; block < end; ++block, values += block_values) {
#if defined(__x86_64__)
    if (avx2) {
      sum_block_avx2(view, c, block, values);
      continue;
    }
#endif
    sum_block(view, c, block, values);
  }
  static_cast<void>(avx2);
}

void sum_modes_at(const ImpulseResponseView& view, const WholeCoordinates& c, std::uint32_t vertex,
                  float* value) noexcept {
  const std::uint32_t block = vertex / layout::block_vertices;
  const std::size_t place = std::size_t{6} * (vertex % layout::block_vertices);  // of its first byte among a pair's
  std::int32_t sums[layout::most_planes][3] = {};
  for (std::uint32_t plane = 0; plane < c.planes; ++plane) {
    visit_groups(view, c, plane, block, [&](const std::int8_t* at, const std::int16_t* of, std::uint32_t pairs) {
      for (std::uint32_t p = 0; p < pairs; ++p) {
        const std::int8_t* const pair = at + pair_bytes * p + place;
        for (std::size_t k = 0; k < 3; ++k) {
          sums[plane][k] += pair[2 * k] * of[std::size_t{2} * p] + pair[2 * k + 1] * of[std::size_t{2} * p + 1];
        }
      }
    });
  }
  const float scale = scale_of(view, c, block);
  for (std::size_t k = 0; k < 3; ++k) value[k] = value_of(sums[0][k], sums[1][k], c.planes, scale);
}

}  // namespace greenloop
