#include "runtime/wavelet/block_predictions.hpp"

#include <cstddef>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "runtime/algebra/processor.hpp"
#include "runtime/wavelet/prediction.hpp"

namespace greenloop {
namespace {

template <class Vector>
const Vector& at_offset(const Vector* x, std::uint32_t byte_offset) {
  return *reinterpret_cast<const Vector*>(reinterpret_cast<const std::byte*>(x) + byte_offset);
}

template <unsigned N>
Vector<N> predicted(const std::byte* block, const Vector<N>* x, std::uint32_t source) {
  return product(StoredBlock<N, 16>::load(block), at_offset(x, source));
}

#if defined(__x86_64__)
// where the values of a column stand in each lane's 16 bytes, of which the first two columns have the first and the
// third has the last; the fourth lane is 0
struct Spread {
  std::int8_t byte[3][32] = {};

  constexpr Spread() {
    for (int column = 0; column < 3; ++column) {
      for (int at = 0; at < 32; ++at) {
        const int row = at / 4 % 4;
        const int first = 2 * (3 * column + row) - (column == 2 ? 2 : 0);
        byte[column][at] = static_cast<std::int8_t>(at % 4 < 2 || row == 3 ? -1 : first + at % 4 - 2);
      }
    }
  }
};

[[gnu::target("avx2")]] inline __m256i two_vectors(const void* low, const void* high) {
  return _mm256_loadu2_m128i(static_cast<const __m128i*>(high), static_cast<const __m128i*>(low));
}

[[gnu::target("avx2")]] inline __m256 column_of(__m256i two, const std::int8_t (&byte)[32]) {
  const __m256i order = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(byte));
  return _mm256_cvtepi32_ps(_mm256_shuffle_epi8(two, order));
}

// terms 2 k in the low halves, 2 k + 1 in the high ones
[[gnu::target("avx2")]] void predict_blocks_avx2(const LevelView& level, const std::uint32_t* sources, Float4* details,
                                                 Float4* x) noexcept {
  static constexpr Spread spread;
  constexpr std::size_t block_bytes = StoredBlock<3, 16>::bytes;
  const std::uint32_t terms = level.predictions.terms;
  const std::byte* block = level.predictions.weight;
  const __m128 unit = _mm_set1_ps(weight_unit<3>);
  auto* node = reinterpret_cast<float*>(x + level.node_begin);
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i, node += 4) {
    __m256 sum = _mm256_setzero_ps();
    std::uint32_t k = 0;
    for (; k + 2 <= terms; k += 2, block += 2 * block_bytes, sources += 2) {
      const __m256i first = two_vectors(block, block + block_bytes);
      const __m256i last = two_vectors(block + 2, block + block_bytes + 2);
      const __m256 from = _mm256_castsi256_ps(two_vectors(&at_offset(x, sources[0]), &at_offset(x, sources[1])));
      const __m256 moved =
          _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(column_of(first, spread.byte[0]), _mm256_permute_ps(from, 0x00)),
                                      _mm256_mul_ps(column_of(first, spread.byte[1]), _mm256_permute_ps(from, 0x55))),
                        _mm256_mul_ps(column_of(last, spread.byte[2]), _mm256_permute_ps(from, 0xaa)));
      sum = _mm256_add_ps(sum, moved);
    }
    __m128 even = _mm256_castps256_ps128(sum);
    if (k < terms) {
      const Float4 moved = predicted<3>(block, x, *sources++);
      even = _mm_add_ps(even, reinterpret_cast<__m128>(xyz(moved)));
      block += block_bytes;
    }
    __m128 whole = _mm_mul_ps(unit, _mm_add_ps(even, _mm256_extractf128_ps(sum, 1)));
    if (details != nullptr) {
      whole = _mm_add_ps(whole, reinterpret_cast<__m128>(details[i]));
      details[i] = Float4{};
    }
    _mm_store_ps(node, whole);
  }
}
#endif

}  // namespace

template <unsigned N>
void predict_blocks(const LevelView& level, const std::uint32_t* sources, Vector<N>* details, Vector<N>* x) noexcept {
  constexpr std::size_t block_bytes = StoredBlock<N, 16>::bytes;
  const std::uint32_t terms = level.predictions.terms;
  const std::byte* block = level.predictions.weight;
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    Vector<N> even{};
    Vector<N> odd{};
    std::uint32_t k = 0;
    for (; k + 2 <= terms; k += 2, block += 2 * block_bytes, sources += 2) {
      even += predicted<N>(block, x, sources[0]);
      odd += predicted<N>(block + block_bytes, x, sources[1]);
    }
    if (k < terms) {
      even += predicted<N>(block, x, *sources++);
      block += block_bytes;
    }
    Vector<N>& node = x[level.node_begin + i];
    node = components(scaled(weight_unit<N>, even + odd));
    if (details != nullptr) {
      node = added(node, details[i]);
      details[i] = Vector<N>{};
    }
  }
}

template void predict_blocks<1>(const LevelView&, const std::uint32_t*, Vector<1>*, Vector<1>*) noexcept;
template void predict_blocks<3>(const LevelView&, const std::uint32_t*, Vector<3>*, Vector<3>*) noexcept;

template <>
PredictBlocks<1> fastest_predict_blocks<1>() noexcept {
  return predict_blocks<1>;
}

template <>
PredictBlocks<3> fastest_predict_blocks<3>() noexcept {
#if defined(__x86_64__)
  if (has_avx2()) {
    return predict_blocks_avx2;
  }
#endif
  return predict_blocks<3>;
}

}  // namespace greenloop
