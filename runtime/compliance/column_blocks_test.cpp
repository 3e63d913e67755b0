#include "runtime/compliance/column_blocks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "runtime/compliance/couplings.hpp"
#include "runtime/testing/rooms.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t places = 37;

// blocks of a layer in memory of their own, each in another row
template <unsigned N>
struct Blocks {
  Blocks(std::uint32_t layer, std::size_t count, std::uint32_t index_bytes)
      : bits(layout::value_bits[layer]), value(layout::block_bytes(N, bits) * count + 16), rows(4 * count + 8) {
    view = {.columns = 1, .rows = places, .index_bytes = index_bytes, .begin = nullptr};
    view.index = rows.data();
    view.value = value.data();
  }

  void set_row(std::size_t b, std::uint32_t row) {
    if (view.index_bytes == 2) {
      const auto two = static_cast<std::uint16_t>(row);
      std::memcpy(rows.data() + 2 * b, &two, sizeof two);
    } else {
      std::memcpy(rows.data() + 4 * b, &row, sizeof row);
    }
  }

  void set(std::size_t b, std::size_t k, int stored) {
    std::byte* const block = value.data() + layout::block_bytes(N, bits) * b;
    if (bits == 4) {
      block[k / 2] |= static_cast<std::byte>((stored & 15) << (k % 2 == 0 ? 0 : 4));
    } else if (bits == 8) {
      block[k] = static_cast<std::byte>(stored);
    } else {
      const auto two = static_cast<std::int16_t>(stored);
      std::memcpy(block + 2 * k, &two, sizeof two);
    }
  }

  std::uint32_t bits;
  std::vector<std::byte> value, rows;
  CouplingsView view;
};

template <unsigned N>
struct Sums {
  Vector<N> value[places] = {};
  friend bool operator==(const Sums& a, const Sums& b) { return std::memcmp(a.value, b.value, sizeof a.value) == 0; }
};

template <unsigned N>
Blocks<N> any_blocks(std::uint32_t layer, std::size_t count, std::uint32_t index_bytes, std::mt19937_64& random) {
  Blocks<N> blocks(layer, count, index_bytes);
  const int most = (1 << (blocks.bits - 1)) - 1;
  for (std::size_t b = 0; b < count; ++b) {
    blocks.set_row(b, static_cast<std::uint32_t>((5 * b + count) % places));
    for (std::size_t k = 0; k < N * N; ++k) {
      blocks.set(b, k, static_cast<int>(random() % static_cast<std::uint64_t>(2 * most + 1)) - most);
    }
  }
  return blocks;
}

float any_force(std::mt19937_64& random) {
  return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) *
         std::ldexp(1.0F, static_cast<int>(random() % 60) - 30);
}

TEST_CASE_TEMPLATE("the fastest sum of blocks has the bits of the one of every processor, for any number of them",
                   Components, One, Three) {
  constexpr unsigned N = Components::value;
  std::mt19937_64 random(11);
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    for (std::size_t count = 0; count < places; ++count) {
      for (const std::uint32_t index_bytes : {2U, 4U}) {
        CAPTURE(layer);
        CAPTURE(count);
        Sums<N> plain;
        Sums<N> fastest;
        for (int column = 0; column < 10; ++column) {
          const Blocks<N> blocks = any_blocks<N>(layer, count, index_bytes, random);
          const float numbers[] = {any_force(random), any_force(random), any_force(random)};
          const Vector<N> force = load_vector<N>(numbers);
          const BlockRange range{&blocks.view, 0, static_cast<std::uint32_t>(count)};
          portable_block_sums<N>().add[layer](range, force, plain.value);
          fastest_block_sums<N>().add[layer](range, force, fastest.value);
        }
        CHECK(plain == fastest);
      }
    }
  }
}

TEST_CASE_TEMPLATE("every value of a block counts, in quanta, and only its own row moves", Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (const BlockSums<N>& sums : {portable_block_sums<N>(), fastest_block_sums<N>()}) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      for (std::size_t b = 0; b < 5; ++b) {
        for (std::size_t k = 0; k < N * N; ++k) {
          for (const int stored : {5, -7}) {
            Blocks<N> blocks(layer, 5, 2);
            for (std::size_t other = 0; other < 5; ++other) {
              blocks.set_row(other, static_cast<std::uint32_t>(7 * other + 1));
            }
            blocks.set(b, k, stored);
            Sums<N> found;
            layout::Info info{};
            info.quantum[layer] = 1;
            const float unit = block_factor<N>(info, layer);
            const float numbers[] = {2 * unit, 4 * unit, 8 * unit};
            const Vector<N> force = load_vector<N>(numbers);
            sums.add[layer]({&blocks.view, static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(b + 1)}, force,
                            found.value);
            for (std::uint32_t i = 0; i < places; ++i) {
              const bool moved = i == 7 * b + 1;
              for (std::size_t r = 0; r < N; ++r) {
                const float expected = static_cast<float>(stored << (k / N + 1));
                CHECK(component(found.value[i], r) == (moved && r == k % N ? expected : 0.0F));
              }
              CHECK(is_padded(found.value[i]));
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
