#include "runtime/compliance/column_blocks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace greenloop {
namespace {

constexpr std::uint32_t places = 37;

// blocks of a layer in memory of their own, each in another row
struct Blocks {
  Blocks(std::uint32_t layer, std::size_t count, std::uint32_t index_bytes)
      : bits(layout::value_bits[layer]), value((9 * bits * count + 7) / 8 * 8 + 16), rows(4 * count + 8) {
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
    std::byte* const block = value.data() + (9 * bits + 7) / 8 * b;
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

struct Sums {
  Float4 value[places] = {};
  friend bool operator==(const Sums& a, const Sums& b) { return std::memcmp(a.value, b.value, sizeof a.value) == 0; }
};

Blocks any_blocks(std::uint32_t layer, std::size_t count, std::uint32_t index_bytes, std::mt19937_64& random) {
  Blocks blocks(layer, count, index_bytes);
  const int most = (1 << (blocks.bits - 1)) - 1;
  for (std::size_t b = 0; b < count; ++b) {
    blocks.set_row(b, static_cast<std::uint32_t>((5 * b + count) % places));
    for (std::size_t k = 0; k < 9; ++k) {
      blocks.set(b, k, static_cast<int>(random() % static_cast<std::uint64_t>(2 * most + 1)) - most);
    }
  }
  return blocks;
}

float any_force(std::mt19937_64& random) {
  return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) *
         std::ldexp(1.0F, static_cast<int>(random() % 60) - 30);
}

TEST_CASE("the fastest sum of blocks has the bits of the one of every processor, for any number of them") {
  std::mt19937_64 random(11);
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    for (std::size_t count = 0; count < places; ++count) {
      for (const std::uint32_t index_bytes : {2U, 4U}) {
        CAPTURE(layer);
        CAPTURE(count);
        Sums plain;
        Sums fastest;
        for (int column = 0; column < 10; ++column) {
          const Blocks blocks = any_blocks(layer, count, index_bytes, random);
          const Float4 force = {any_force(random), any_force(random), any_force(random), 0.0F};
          const BlockRange range{&blocks.view, 0, static_cast<std::uint32_t>(count)};
          portable_block_sums<3>().add[layer](range, force, plain.value);
          fastest_block_sums<3>().add[layer](range, force, fastest.value);
        }
        CHECK(plain == fastest);
      }
    }
  }
}

TEST_CASE("every value of a block counts, in quanta, and only its own row moves") {
  for (const BlockSums<3>& sums : {portable_block_sums<3>(), fastest_block_sums<3>()}) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      for (std::size_t b = 0; b < 5; ++b) {
        for (std::size_t k = 0; k < 9; ++k) {
          for (const int stored : {5, -7}) {
            Blocks blocks(layer, 5, 2);
            for (std::size_t other = 0; other < 5; ++other) {
              blocks.set_row(other, static_cast<std::uint32_t>(7 * other + 1));
            }
            blocks.set(b, k, stored);
            Sums found;
            const float widening = layer < 2 ? 0x1p-16F : layer == 2 ? 0x1p-24F : 0x1p-28F;
            const Float4 force = {2 * widening, 4 * widening, 8 * widening, 0.0F};
            sums.add[layer]({&blocks.view, static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(b + 1)}, force,
                            found.value);
            for (std::uint32_t i = 0; i < places; ++i) {
              const bool moved = i == 7 * b + 1;
              for (std::size_t r = 0; r < 4; ++r) {
                const float expected = static_cast<float>(stored << (k / 3 + 1));
                CHECK(float{found.value[i][r]} == (moved && r == k % 3 ? expected : 0.0F));
              }
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
