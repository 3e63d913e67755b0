#include "runtime/compliance/base_columns.hpp"

#include <cstddef>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "formats/stored_blocks.hpp"
#include "runtime/algebra/processor.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t eight_bits = BaseColumns::quantum_layer;
constexpr std::uint32_t four_bits = 3;
constexpr std::uint32_t least_domain = 512;
static_assert(layout::value_bits[eight_bits] == 8 && layout::value_bits[four_bits] == 4);

// calls visit(couplings, layer, row, column among all coefficients, position) for the blocks of level 0's rows
template <class Visit>
void visit_base(const ModelView& view, const bool (&holds)[layout::layers], Visit visit) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = level.couplings[layer];
      for (std::uint32_t j = 0; holds[layer] && j < couplings.columns; ++j) {
        visit_rows(couplings, j, 0, domain_up_to(view, 0), [&](std::uint32_t row, std::uint32_t position) {
          visit(couplings, layer, row, level.domain_begin + j, position);
        });
      }
    }
  }
}

// whether a block of level 0's rows has a part in both layers
bool share_blocks(const ModelView& view) {
  bool shared = false;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const CouplingsView& other = view.level[q].couplings[eight_bits];
    const CouplingsView& couplings = view.level[q].couplings[four_bits];
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      visit_rows(couplings, j, 0, domain_up_to(view, 0), [&](std::uint32_t row, std::uint32_t) {
        visit_rows(other, j, row, row + 1, [&](std::uint32_t, std::uint32_t) { shared = true; });
      });
    }
  }
  return shared;
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] inline __m256 load_eight(const std::byte* bytes) {
  return _mm256_cvtepi32_ps(_mm256_cvtepi8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes))));
}

// a row of blocks in one operation, each lane as add_tiles has it
[[gnu::target("avx2")]] void add_tiles_avx2(const std::byte* tiles, std::uint32_t count, Float4 force,
                                            TileSums* sums) noexcept {
  const __m256 f0 = _mm256_set1_ps(force[0]);
  const __m256 f1 = _mm256_set1_ps(force[1]);
  const __m256 f2 = _mm256_set1_ps(force[2]);
  for (std::uint32_t t = 0; t < count; ++t, tiles += BaseColumns::tile_bytes) {
    for (std::size_t r = 0; r < 3; ++r) {
      auto* const sum = reinterpret_cast<float*>(sums[t].of[r]);
      const __m256 moved = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(load_eight(tiles + 8 * r), f0),
                                                       _mm256_mul_ps(load_eight(tiles + 8 * (r + 3)), f1)),
                                         _mm256_mul_ps(load_eight(tiles + 8 * (r + 6)), f2));
      _mm256_storeu_ps(sum, _mm256_add_ps(_mm256_loadu_ps(sum), moved));
    }
  }
}
#endif

}  // namespace

#if defined(__SSE2__) || defined(__ARM_NEON)
void add_tiles(const std::byte* tiles, std::uint32_t count, Float4 force, TileSums* sums) noexcept {
  const Float4 f0 = splat(force[0] * StoredBlock<8>::widening);
  const Float4 f1 = splat(force[1] * StoredBlock<8>::widening);
  const Float4 f2 = splat(force[2] * StoredBlock<8>::widening);
  for (std::uint32_t t = 0; t < count; ++t, tiles += BaseColumns::tile_bytes) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t half = 0; half < 2; ++half) {
        const auto element = [&](std::size_t k) { return detail::load_bytes(tiles + 8 * k + 4 * half); };
        sums[t].of[r][half] += (element(r) * f0 + element(r + 3) * f1) + element(r + 6) * f2;
      }
    }
  }
}
#else
void add_tiles(const std::byte* tiles, std::uint32_t count, Float4 force, TileSums* sums) noexcept {
  const auto* value = reinterpret_cast<const std::int8_t*>(tiles);
  auto* sum = reinterpret_cast<float*>(sums);
  const float f0 = force[0];
  const float f1 = force[1];
  const float f2 = force[2];
  for (std::uint32_t t = 0; t < count; ++t, value += BaseColumns::tile_bytes) {
    for (std::uint32_t k = 0; k < 3 * BaseColumns::width; ++k, ++sum) {
      *sum += (static_cast<float>(value[k]) * f0 + static_cast<float>(value[k + 24]) * f1) +
              static_cast<float>(value[k + 48]) * f2;
    }
  }
}
#endif

AddTiles fastest_add_tiles() noexcept {
#if defined(__x86_64__)
  if (has_avx2()) {
    return add_tiles_avx2;
  }
#endif
  return add_tiles;
}

void BaseColumnsMaker::carve(Arena& arena, const ModelView& view) noexcept {
  made_ = {};
  made_.holds[eight_bits] = true;
  made_.holds[four_bits] = view.info->quantum[four_bits] == view.info->quantum[eight_bits] && !share_blocks(view);
  std::uint64_t blocks = 0;
  visit_base(view, made_.holds,
             [&](const CouplingsView&, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t) { ++blocks; });
  const std::uint32_t columns = domain_up_to(view, 0);
  const std::uint64_t all = std::uint64_t{columns} * tiles_of(view.domain_count) * BaseColumns::width;
  // tiles of fewer blocks take more memory and time than those, and short columns do not pay where there are no vectors
  if (4 * blocks < 3 * all || view.domain_count < least_domain) {
    made_ = {};
    return;
  }
  made_.columns = columns;
  made_.tiles = tiles_of(view.domain_count);
  value_ = arena.take_zeroed<std::byte>(BaseColumns::tile_bytes * made_.tiles * columns);
}

BaseColumns BaseColumnsMaker::make(const ModelView& view) noexcept {
  visit_base(view, made_.holds,
             [&](const CouplingsView& couplings, std::uint32_t layer, std::uint32_t row, std::uint32_t column,
                 std::uint32_t position) {
               std::byte* const tile =
                   value_ + BaseColumns::tile_bytes * (std::size_t{made_.tiles} * row + column / BaseColumns::width);
               for (std::uint32_t k = 0; k < 9; ++k) {  // transposed
                 std::byte& element = tile[8 * (3 * (k % 3) + k / 3) + column % BaseColumns::width];
                 const int value = stored_value<3>(couplings, layout::value_bits[layer], position, k);
                 element = static_cast<std::byte>(static_cast<std::int8_t>(element) + value);
               }
             });
  made_.value = value_;
  return made_;
}

}  // namespace greenloop
