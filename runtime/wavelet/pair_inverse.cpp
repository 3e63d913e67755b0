#include "runtime/wavelet/pair_inverse.hpp"

#include <cstddef>
#include <cstring>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "runtime/algebra/processor.hpp"
#include "runtime/algebra/stored_block.hpp"

namespace greenloop {
namespace {

using Term = SparseInverse::Term;

// calls add_numbers(terms, their end, x, target) or add_blocks(terms, their end, first stored block, x, target) for
// each step
template <unsigned N, class AddNumbers, class AddBlocks>
[[gnu::always_inline]] inline void visit_steps(const SparseInverse& inverse, std::uint32_t steps, BlockPair<N>* x,
                                               AddNumbers add_numbers, AddBlocks add_blocks) {
  const Term* term = inverse.term;
  for (std::uint32_t k = 0; k < steps; ++k) {
    const auto& [target, last] = inverse.step[k];
    const Term* const end = inverse.term + last;
    const std::byte* const block = inverse.block == nullptr ? nullptr : inverse.block[k];
    if (block == nullptr) {
      add_numbers(term, end, x, x[target]);
    } else {
      add_blocks(term, end, block, x, x[target]);
    }
    term = end;
  }
}

// the sum of a step's terms alone: details are smaller than what they are added to
template <unsigned N>
void add_numbers(const Term* term, const Term* end, const BlockPair<N>* x, BlockPair<N>& target) {
  BlockPair<N> sum{};
  for (; term != end; ++term) {
    add(term->weight, x[term->source].row[0], sum.row[0]);
    add(term->weight, x[term->source].row[1], sum.row[1]);
  }
  add(sum.row[0], target.row[0]);
  add(sum.row[1], target.row[1]);
}

template <unsigned N>
void add_blocks(const Term* term, const Term* end, const std::byte* stored, const BlockPair<N>* x,
                BlockPair<N>& target) {
  BlockPair<N> sum{};
  for (; term != end; ++term, stored += StoredBlock<N, 16>::bytes) {
    const BlockSplats<N> weight = splats(transposed(StoredBlock<N, 16>::load(stored)));
    add(product(x[term->source].row[0], weight), sum.row[0]);
    add(product(x[term->source].row[1], weight), sum.row[1]);
  }
  add(scaled(weight_unit<N>, sum.row[0]), target.row[0]);
  add(scaled(weight_unit<N>, sum.row[1]), target.row[1]);
}

#if defined(__x86_64__)
static_assert(sizeof(BlockPair<3>) == 3 * sizeof(__m256));

// two columns of a pair in one operation
[[gnu::target("avx2")]] inline void add_numbers_avx2(const Term* term, const Term* end, const BlockPair<3>* x,
                                                     BlockPair<3>& target) {
  __m256 sum[3] = {_mm256_setzero_ps(), _mm256_setzero_ps(), _mm256_setzero_ps()};
  for (; term != end; ++term) {
    const __m256 weight = _mm256_set1_ps(term->weight);
    const auto* source = reinterpret_cast<const float*>(x + term->source);
    for (std::size_t k = 0; k < 3; ++k) {
      sum[k] = _mm256_add_ps(sum[k], _mm256_mul_ps(weight, _mm256_loadu_ps(source + 8 * k)));
    }
  }
  auto* at = reinterpret_cast<float*>(&target);
  for (std::size_t k = 0; k < 3; ++k) {
    _mm256_storeu_ps(at + 8 * k, _mm256_add_ps(_mm256_loadu_ps(at + 8 * k), sum[k]));
  }
}

// column k of the first row in the low half, of the second in the high one
[[gnu::target("avx2")]] inline __m256 column_of(const BlockPair<3>& x, std::size_t k) {
  const __m256 first = _mm256_castps128_ps256(_mm_load_ps(reinterpret_cast<const float*>(&x.row[0].column[k])));
  const __m256 second = _mm256_broadcast_ps(reinterpret_cast<const __m128*>(&x.row[1].column[k]));
  return _mm256_blend_ps(first, second, 0xf0);
}

// the elements of a stored block, as StoredBlock has them, in both halves: those of even number up to 6, those of odd
// number, and the last in lane 3
struct Elements {
  __m256 even, odd, last;

  [[gnu::target("avx2")]] explicit Elements(const std::byte* stored)
      : even(_mm256_cvtepi32_ps(_mm256_slli_epi32(halves(stored), 16))),
        odd(upper(halves(stored))),
        last(upper(halves(stored + 2))) {}

  [[gnu::target("avx2")]] static __m256i halves(const std::byte* stored) {
    return _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(stored)));
  }
  [[gnu::target("avx2")]] static __m256 upper(__m256i pairs) {
    return _mm256_cvtepi32_ps(_mm256_and_si256(pairs, _mm256_set1_epi32(static_cast<int>(0xffff0000))));
  }
};

// x times an element in all lanes of each half
template <int lane>
[[gnu::target("avx2")]] inline __m256 times(__m256 x, __m256 elements) {
  return _mm256_mul_ps(x, _mm256_permute_ps(elements, 0x55 * lane));
}

[[gnu::target("avx2")]] inline __m256 sum_of(__m256 a, __m256 b, __m256 c) {
  return _mm256_add_ps(_mm256_add_ps(a, b), c);
}

// two rows in one operation
[[gnu::target("avx2")]] inline void add_blocks_avx2(const Term* term, const Term* end, const std::byte* stored,
                                                    const BlockPair<3>* x, BlockPair<3>& target) {
  __m256 sum[3] = {_mm256_setzero_ps(), _mm256_setzero_ps(), _mm256_setzero_ps()};
  for (; term != end; ++term, stored += StoredBlock<3, 16>::bytes) {
    const auto [even, odd, last] = Elements(stored);
    const __m256 x0 = column_of(x[term->source], 0);
    const __m256 x1 = column_of(x[term->source], 1);
    const __m256 x2 = column_of(x[term->source], 2);
    sum[0] = _mm256_add_ps(sum[0], sum_of(times<0>(x0, even), times<1>(x1, odd), times<3>(x2, even)));
    sum[1] = _mm256_add_ps(sum[1], sum_of(times<0>(x0, odd), times<2>(x1, even), times<3>(x2, odd)));
    sum[2] = _mm256_add_ps(sum[2], sum_of(times<1>(x0, even), times<2>(x1, odd), times<3>(x2, last)));
  }
  const __m256 unit = _mm256_set1_ps(weight_unit<3>);
  for (std::size_t k = 0; k < 3; ++k) {
    const __m256 moved = _mm256_add_ps(column_of(target, k), _mm256_mul_ps(unit, sum[k]));
    _mm256_storeu2_m128(reinterpret_cast<float*>(&target.row[1].column[k]),
                        reinterpret_cast<float*>(&target.row[0].column[k]), moved);
  }
}

[[gnu::target("avx2")]] void invert_pair_avx2(const SparseInverse& inverse, std::uint32_t steps,
                                              BlockPair<3>* x) noexcept {
  visit_steps<3>(inverse, steps, x, add_numbers_avx2, add_blocks_avx2);
  _mm256_zeroupper();
}
#endif

}  // namespace

template <unsigned N>
void invert_pair(const SparseInverse& inverse, std::uint32_t steps, BlockPair<N>* x) noexcept {
  visit_steps<N>(inverse, steps, x, add_numbers<N>, add_blocks<N>);
}

template void invert_pair<1>(const SparseInverse&, std::uint32_t, BlockPair<1>*) noexcept;
template void invert_pair<3>(const SparseInverse&, std::uint32_t, BlockPair<3>*) noexcept;

template <>
InvertPair<1> fastest_invert_pair<1>() noexcept {
  return invert_pair<1>;
}

template <>
InvertPair<3> fastest_invert_pair<3>() noexcept {
#if defined(__x86_64__)
  if (has_avx2()) {
    return invert_pair_avx2;
  }
#endif
  return invert_pair<3>;
}

}  // namespace greenloop
