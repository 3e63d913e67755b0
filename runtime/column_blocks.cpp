#include "runtime/column_blocks.hpp"

#include <bit>
#include <cstddef>
#include <cstring>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace greenloop {
namespace {

#if defined(__SSE2__) || defined(__ARM_NEON)
// blocks times one force; fourth lanes: any of a block's values times 0
class Product {
 public:
  explicit Product(Float4 force) : force_{splat3(force[0]), splat3(force[1]), splat3(force[2])} {}

  void add(const ColumnBlock& block, Float4& sum) const {
    const Block values{{detail::load_upper_halves(block.value), detail::load_upper_halves(block.value + 3),
                        detail::load_upper_halves(block.value + 6)}};
    sum += product(values, force_);
  }

 private:
  Float4 force_[3];
};
#else
// the same on a processor without vectors: three lanes, two values a load
class Product {
 public:
  explicit Product(Float4 force) : force_{force[0], force[1], force[2]} {}

  void add(const ColumnBlock& block, Float4& sum) const {
    const std::uint32_t v01 = pair(block, 0);
    const std::uint32_t v23 = pair(block, 2);
    const std::uint32_t v45 = pair(block, 4);
    const std::uint32_t v67 = pair(block, 6);
    auto* const x = reinterpret_cast<float*>(&sum);
    x[0] += (first(v01) * force_[0] + second(v23) * force_[1]) + first(v67) * force_[2];
    x[1] += (second(v01) * force_[0] + first(v45) * force_[1]) + second(v67) * force_[2];
    x[2] += (first(v23) * force_[0] + second(v45) * force_[1]) + first(pair(block, 8)) * force_[2];
  }

 private:
  static std::uint32_t pair(const ColumnBlock& block, std::size_t at) {
    std::uint32_t two;
    std::memcpy(&two, reinterpret_cast<const std::byte*>(&block) + offsetof(ColumnBlock, value) + 2 * at, sizeof two);
    return two;
  }
  static float first(std::uint32_t two) { return std::bit_cast<float>(two << 16); }
  static float second(std::uint32_t two) { return std::bit_cast<float>(two & 0xffff0000); }

  float force_[3];
};
#endif

#if defined(__x86_64__)
// whether the processor has the instructions and the operating system keeps their registers
bool has_avx2() {
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  std::uint32_t c = 0;
  std::uint32_t d = 0;
  asm("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  constexpr std::uint32_t avx_and_xgetbv = 3U << 27;
  if ((c & avx_and_xgetbv) != avx_and_xgetbv) {
    return false;
  }
  asm("xgetbv" : "=a"(a), "=d"(d) : "c"(0));
  if ((a & 6) != 6) {
    return false;
  }
  a = 7;
  c = 0;
  asm("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  return (b & 1U << 5) != 0;
}

// where the values of a block's columns stand, as upper halves of three floats, in 16 of its bytes
constexpr std::int8_t of_first[16] = {-1, -1, 4, 5, -1, -1, 6, 7, -1, -1, 8, 9, -1, -1, -1, -1};
constexpr std::int8_t of_second[16] = {-1, -1, 10, 11, -1, -1, 12, 13, -1, -1, 14, 15, -1, -1, -1, -1};
constexpr std::int8_t of_third[16] = {-1, -1, 8, 9, -1, -1, 10, 11, -1, -1, 12, 13, -1, -1, -1, -1};  // from byte 8 on

[[gnu::target("avx2")]] inline __m256i twice(const std::int8_t (&bytes)[16]) {
  const auto* at = reinterpret_cast<const __m128i*>(bytes);
  return _mm256_loadu2_m128i(at, at);
}

// two blocks in one operation, each lane as add_blocks has it
[[gnu::target("avx2")]] void add_blocks_avx2(const ColumnBlock* first, const ColumnBlock* last, Float4 force,
                                             const SparseCoefficients& sums) noexcept {
  constexpr std::ptrdiff_t at_once = 4;
  const __m256 lanes = _mm256_castsi256_ps(_mm256_setr_epi32(-1, -1, -1, 0, -1, -1, -1, 0));
  const __m256 f0 = _mm256_and_ps(_mm256_set1_ps(force[0]), lanes);
  const __m256 f1 = _mm256_and_ps(_mm256_set1_ps(force[1]), lanes);
  const __m256 f2 = _mm256_and_ps(_mm256_set1_ps(force[2]), lanes);
  const __m256i first_column = twice(of_first);
  const __m256i second_column = twice(of_second);
  const __m256i third_column = twice(of_third);
  auto* const value = reinterpret_cast<std::byte*>(sums.value);
  std::uint8_t* const touched = sums.touched;
  const ColumnBlock* at = first;
  for (; last - at >= at_once; at += at_once) {
    for (std::ptrdiff_t k = 0; k < at_once; k += 2) {
      const auto* low = reinterpret_cast<const std::byte*>(at + k);
      const auto* high = reinterpret_cast<const std::byte*>(at + k + 1);
      const __m256i begin =
          _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(high), reinterpret_cast<const __m128i*>(low));
      const __m256i end =
          _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(high + 8), reinterpret_cast<const __m128i*>(low + 8));
      const __m256 v0 = _mm256_castsi256_ps(_mm256_shuffle_epi8(begin, first_column));
      const __m256 v1 = _mm256_castsi256_ps(_mm256_shuffle_epi8(begin, second_column));
      const __m256 v2 = _mm256_castsi256_ps(_mm256_shuffle_epi8(end, third_column));
      const __m256 moved =
          _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(v0, f0), _mm256_mul_ps(v1, f1)), _mm256_mul_ps(v2, f2));
      auto* const of_low = reinterpret_cast<float*>(value + at[k].byte_offset);
      _mm_store_ps(of_low, _mm_add_ps(_mm_load_ps(of_low), _mm256_castps256_ps128(moved)));
      auto* const of_high = reinterpret_cast<float*>(value + at[k + 1].byte_offset);
      _mm_store_ps(of_high, _mm_add_ps(_mm_load_ps(of_high), _mm256_extractf128_ps(moved, 1)));
      touched[moved_place(at[k])] = 1;
      touched[moved_place(at[k + 1])] = 1;
    }
  }
  add_blocks(at, last, force, sums);
}
#endif

}  // namespace

void add_blocks(const ColumnBlock* first, const ColumnBlock* last, Float4 force,
                const SparseCoefficients& sums) noexcept {
  const Product product_with_force(force);
  auto* const value = reinterpret_cast<std::byte*>(sums.value);
  std::uint8_t* const touched = sums.touched;
  for (const ColumnBlock* at = first; at != last; ++at) {
    product_with_force.add(*at, *reinterpret_cast<Float4*>(value + at->byte_offset));
    touched[moved_place(*at)] = 1;
  }
}

AddBlocks fastest_add_blocks() noexcept {
#if defined(__x86_64__)
  if (has_avx2()) {
    return add_blocks_avx2;
  }
#endif
  return add_blocks;
}

}  // namespace greenloop
