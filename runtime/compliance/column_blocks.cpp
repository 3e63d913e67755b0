#include "runtime/compliance/column_blocks.hpp"

#include <cstddef>
#include <cstring>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "runtime/algebra/processor.hpp"
#include "runtime/algebra/stored_block.hpp"

namespace greenloop {
namespace {

// stored blocks of `bits` a value times one force
template <unsigned N, unsigned bits>
class Product {
 public:
  explicit Product(Vector<N> force) : force_(component_splats(force)) {}

  void add(const std::byte* value, Vector<N>& sum) const { sum += product(StoredBlock<N, bits>::load(value), force_); }

 private:
  Splats<N> force_;
};

#if !defined(__SSE2__) && !defined(__ARM_NEON)
// two values of 4 bits by the byte that holds them
struct Nibbles {
  float pair[256][2] = {};

  constexpr Nibbles() {
    for (int byte = 0; byte < 256; ++byte) {
      pair[byte][0] = static_cast<float>((byte % 16 ^ 8) - 8);
      pair[byte][1] = static_cast<float>((byte / 16 ^ 8) - 8);
    }
  }
};
constexpr Nibbles nibbles;

// element k of a stored 3x3 block, in quanta
template <unsigned bits>
float element(const std::byte* value, std::size_t k) {
  if constexpr (bits == 4) {  // one load instead of three instructions
    return nibbles.pair[std::to_integer<std::size_t>(value[k / 2])][k % 2];
  } else if constexpr (bits == 8) {
    return static_cast<float>(static_cast<std::int8_t>(value[k]));
  } else {
    std::int16_t two;
    std::memcpy(&two, value + 2 * k, sizeof two);
    return static_cast<float>(two);
  }
}

// the same on a processor without vectors: three lanes; the powers of two of the stored values are in the force
template <unsigned bits>
class Product<3, bits> {
 public:
  explicit Product(Float4 force)
      : force_{force[0] / StoredBlock<3, bits>::widening, force[1] / StoredBlock<3, bits>::widening,
               force[2] / StoredBlock<3, bits>::widening} {}

  void add(const std::byte* value, Float4& sum) const {
    const auto moved = [&](std::size_t r) {
      return (element<bits>(value, r) * force_[0] + element<bits>(value, r + 3) * force_[1]) +
             element<bits>(value, r + 6) * force_[2];
    };
    const float by[] = {moved(0), moved(1), moved(2)};  // before what a value might be part of is written
    auto* const x = reinterpret_cast<float*>(&sum);
    x[0] += by[0];
    x[1] += by[1];
    x[2] += by[2];
  }

 private:
  float force_[3];
};
#endif

template <unsigned N, unsigned bits, class Index>
void add_each(const CouplingsView& couplings, std::uint32_t begin, std::uint32_t end, Vector<N> force,
              Vector<N>* sums) {
  constexpr std::size_t bytes = StoredBlock<N, bits>::bytes;
  const Product<N, bits> product_with_force(force);
  const auto* const row = static_cast<const Index*>(couplings.index);
  const std::byte* value = couplings.value + bytes * std::size_t{begin};
  for (std::uint32_t at = begin; at < end; ++at, value += bytes) {
    product_with_force.add(value, sums[row[at]]);
  }
}

template <unsigned N, unsigned bits>
void add_blocks(const BlockRange& range, Vector<N> force, Vector<N>* sums) noexcept {
  if (range.couplings->index_bytes == 2) {
    add_each<N, bits, std::uint16_t>(*range.couplings, range.begin, range.end, force, sums);
  } else {
    add_each<N, bits, std::uint32_t>(*range.couplings, range.begin, range.end, force, sums);
  }
}

#if defined(__x86_64__)
// where the values of a block stand: by column and lane, the byte that goes on top and how far it moves up
template <unsigned bits>
struct Spread {
  std::int8_t byte[3][16] = {};
  std::int32_t shift[3][4] = {};

  constexpr Spread() {
    for (int column = 0; column < 3; ++column) {
      for (int at = 0; at < 16; ++at) {
        const int row = at / 4;
        const int k = 3 * column + row;
        byte[column][at] = static_cast<std::int8_t>(at % 4 != 3 || row == 3 ? -1 : bits == 4 ? k / 2 : k);
      }
      for (int row = 0; row < 3; ++row) {
        shift[column][row] = bits == 4 && (3 * column + row) % 2 == 0 ? 4 : 0;
      }
    }
  }
};

// a column of each of two blocks of 4 or 8 bits a value, as StoredBlock has it; fourth lanes 0
template <unsigned bits>
class TwoColumns {
 public:
  [[gnu::target("avx2")]] TwoColumns(const Spread<bits>& spread, int column)
      : byte_(_mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(spread.byte[column])))),
        shift_(_mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(spread.shift[column])))) {}

  [[gnu::target("avx2")]] __m256 of(__m256i two) const {
    __m256i value = _mm256_shuffle_epi8(two, byte_);
    if constexpr (bits == 4) {
      value = _mm256_and_si256(_mm256_sllv_epi32(value, shift_), _mm256_set1_epi32(static_cast<int>(0xf0000000)));
    }
    return _mm256_cvtepi32_ps(value);
  }

 private:
  __m256i byte_;
  __m256i shift_;
};

[[gnu::target("avx2")]] inline void add_to(Float4& sum, __m128 moved) {
  auto* const at = reinterpret_cast<float*>(&sum);
  _mm_store_ps(at, _mm_add_ps(_mm_load_ps(at), moved));
}

// two blocks in one operation, each lane as add_each has it
template <unsigned bits, class Index>
[[gnu::target("avx2")]] void add_pairs(const CouplingsView& couplings, std::uint32_t begin, std::uint32_t end,
                                       Float4 force, Float4* sums) {
  constexpr std::size_t bytes = StoredBlock<3, bits>::bytes;
  static constexpr Spread<bits> spread;
  const TwoColumns<bits> first(spread, 0);
  const TwoColumns<bits> second(spread, 1);
  const TwoColumns<bits> third(spread, 2);
  const __m256 f0 = _mm256_set1_ps(force[0]);
  const __m256 f1 = _mm256_set1_ps(force[1]);
  const __m256 f2 = _mm256_set1_ps(force[2]);
  const auto* const row = static_cast<const Index*>(couplings.index);
  const std::byte* value = couplings.value + bytes * std::size_t{begin};
  std::uint32_t at = begin;
  for (; end - at >= 2; at += 2, value += 2 * bytes) {
    const __m256i two =
        _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(value + bytes), reinterpret_cast<const __m128i*>(value));
    const __m256 moved =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(first.of(two), f0), _mm256_mul_ps(second.of(two), f1)),
                      _mm256_mul_ps(third.of(two), f2));
    add_to(sums[row[at]], _mm256_castps256_ps128(moved));
    add_to(sums[row[at + 1]], _mm256_extractf128_ps(moved, 1));
  }
  _mm256_zeroupper();  // gcc 12 leaves it out before a call in the end, and all that follows would be slow
  add_each<3, bits, Index>(couplings, at, end, force, sums);
}

template <unsigned bits>
[[gnu::target("avx2")]] void add_blocks_avx2(const BlockRange& range, Float4 force, Float4* sums) noexcept {
  if (range.couplings->index_bytes == 2) {
    add_pairs<bits, std::uint16_t>(*range.couplings, range.begin, range.end, force, sums);
  } else {
    add_pairs<bits, std::uint32_t>(*range.couplings, range.begin, range.end, force, sums);
  }
}
#endif

}  // namespace

template <unsigned N>
BlockSums<N> portable_block_sums() noexcept {
  static_assert(layout::layers == 4 && layout::value_bits[0] == 16 && layout::value_bits[1] == 16 &&
                layout::value_bits[2] == 8 && layout::value_bits[3] == 4);
  static constexpr BlockSums<N> sums = {{add_blocks<N, 16>, add_blocks<N, 16>, add_blocks<N, 8>, add_blocks<N, 4>}};
  return sums;
}

template <>
BlockSums<1> fastest_block_sums<1>() noexcept {
  return portable_block_sums<1>();
}

template <>
BlockSums<3> fastest_block_sums<3>() noexcept {
#if defined(__x86_64__)
  if (has_avx2()) {
    return {{add_blocks<3, 16>, add_blocks<3, 16>, add_blocks_avx2<8>, add_blocks_avx2<4>}};
  }
#endif
  return portable_block_sums<3>();
}

template BlockSums<1> portable_block_sums<1>() noexcept;
template BlockSums<3> portable_block_sums<3>() noexcept;

}  // namespace greenloop
