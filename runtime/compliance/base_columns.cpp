#include "runtime/compliance/base_columns.hpp"

#include <cstddef>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "runtime/algebra/processor.hpp"

namespace greenloop {
namespace {

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
  for (std::uint32_t t = 0; t < count; ++t, value += (N - 1) * N * BaseColumns::width) {
    for (std::size_t r = 0; r < N; ++r, value += BaseColumns::width, sum += BaseColumns::width) {
      for (std::size_t k = 0; k < BaseColumns::width; ++k) {  // short enough to be unrolled
        const auto element = [&](std::size_t c) { return static_cast<float>(value[k + BaseColumns::width * c]); };
        sum[k] += row_product(element, 0, factor);
      }
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
  is_ready_ = view.ready.read != nullptr;
  made_ = is_ready_ ? view.ready.base : base_columns_of(view);
  if (!is_ready_ && made_.columns > 0) {
    value_ = arena.take_zeroed<std::byte>(value_bytes<N>(made_));
  }
}

template <unsigned N>
BaseColumns BaseColumnsMaker<N>::make(const ModelView& view) noexcept {
  if (!is_ready_) {
    fill_base_columns<N>(view, made_, value_);
    made_.value = value_;
  }
  return made_;
}

template class BaseColumnsMaker<1>;
template class BaseColumnsMaker<3>;

}  // namespace greenloop
