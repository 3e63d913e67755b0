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
                                            TileSums<3>* sums) noexcept {
  const __m256 f0 = _mm256_set1_ps(force[0]);
  const __m256 f1 = _mm256_set1_ps(force[1]);
  const __m256 f2 = _mm256_set1_ps(force[2]);
  for (std::uint32_t t = 0; t < count; ++t, tiles += BaseColumns::tile_bytes<3>) {
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

// row r of blocks, by element(k) of each, times a force

template <class Element, class Number>
auto row_product(Element element, std::size_t r, const Number (&force)[3]) {
  return (element(r) * force[0] + element(r + 3) * force[1]) + element(r + 6) * force[2];
}

template <class Element, class Number>
auto row_product(Element element, std::size_t r, const Number (&force)[1]) {
  return element(r) * force[0];
}

}  // namespace

#if defined(__SSE2__) || defined(__ARM_NEON)
template <unsigned N>
void add_tiles(const std::byte* tiles, std::uint32_t count, Vector<N> force, TileSums<N>* sums) noexcept {
  Float4 factor[N];
  for (std::size_t c = 0; c < N; ++c) {
    factor[c] = splat(component(force, c) * detail::byte_widening);
  }
  for (std::uint32_t t = 0; t < count; ++t, tiles += BaseColumns::tile_bytes<N>) {
    for (std::size_t r = 0; r < N; ++r) {
      for (std::size_t half = 0; half < 2; ++half) {
        const auto element = [&](std::size_t k) { return detail::load_bytes(tiles + 8 * k + 4 * half); };
        sums[t].of[r][half] += row_product(element, r, factor);
      }
    }
  }
}
#else
template <unsigned N>
void add_tiles(const std::byte* tiles, std::uint32_t count, Vector<N> force, TileSums<N>* sums) noexcept {
  const auto* value = reinterpret_cast<const std::int8_t*>(tiles);
  auto* sum = reinterpret_cast<float*>(sums);
  float factor[N];
  for (std::size_t c = 0; c < N; ++c) {
    factor[c] = component(force, c);
  }
  for (std::uint32_t t = 0; t < count; ++t, value += BaseColumns::tile_bytes<N>) {
    for (std::uint32_t k = 0; k < N * BaseColumns::width; ++k, ++sum) {
      const auto element = [&](std::size_t c) { return static_cast<float>(value[k + 8 * c]); };
      *sum += row_product(element, 0, factor);
    }
  }
}
#endif

template void add_tiles<1>(const std::byte*, std::uint32_t, Vector<1>, TileSums<1>*) noexcept;
template void add_tiles<3>(const std::byte*, std::uint32_t, Vector<3>, TileSums<3>*) noexcept;

template <>
AddTiles<1> fastest_add_tiles<1>() noexcept {
  return add_tiles<1>;
}

template <>
AddTiles<3> fastest_add_tiles<3>() noexcept {
#if defined(__x86_64__)
  if (has_avx2()) {
    return add_tiles_avx2;
  }
#endif
  return add_tiles<3>;
}

template <unsigned N>
void BaseColumnsMaker<N>::carve(Arena& arena, const ModelView& view) noexcept {
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
  value_ = arena.take_zeroed<std::byte>(BaseColumns::tile_bytes<N> * made_.tiles * columns);
}

template <unsigned N>
BaseColumns BaseColumnsMaker<N>::make(const ModelView& view) noexcept {
  visit_base(view, made_.holds,
             [&](const CouplingsView& couplings, std::uint32_t layer, std::uint32_t row, std::uint32_t column,
                 std::uint32_t position) {
               std::byte* const tile =
                   value_ + BaseColumns::tile_bytes<N> * (std::size_t{made_.tiles} * row + column / BaseColumns::width);
               for (std::uint32_t k = 0; k < N * N; ++k) {  // transposed
                 std::byte& element = tile[8 * (N * (k % N) + k / N) + column % BaseColumns::width];
                 const int value = stored_value<N>(couplings, layout::value_bits[layer], position, k);
                 element = static_cast<std::byte>(static_cast<std::int8_t>(element) + value);
               }
             });
  made_.value = value_;
  return made_;
}

template class BaseColumnsMaker<1>;
template class BaseColumnsMaker<3>;

}  // namespace greenloop
