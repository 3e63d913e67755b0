#include "runtime/column_blocks.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace greenloop {
namespace {

constexpr std::uint32_t places = 37;

// random numbers of both signs between 2^-40 and 2^40 and zeros
float any_value(std::mt19937_64& random) {
  const std::uint64_t bits = random();
  const float magnitude =
      std::ldexp(1.0F + static_cast<float>(bits >> 41) * 0x1p-23F, static_cast<int>(bits % 81) - 40);
  return bits % 13 == 0 ? 0.0F : (bits >> 8 & 1) != 0 ? -magnitude : magnitude;
}

std::vector<ColumnBlock> any_blocks(std::size_t count, std::mt19937_64& random) {
  std::vector<ColumnBlock> blocks(count);
  std::uint32_t place = 0;
  for (ColumnBlock& block : blocks) {
    place = random() % 4 == 0 ? place : static_cast<std::uint32_t>(random() % places);  // some in a row move the same
    block.byte_offset = place * static_cast<std::uint32_t>(sizeof(Float4));
    for (std::uint16_t& value : block.value) {
      value = static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(any_value(random)) >> 16);
    }
    block.zero = 0;
  }
  return blocks;
}

struct Sums {
  Float4 value[places] = {};
  std::uint8_t touched[places] = {};

  void add(AddBlocks variant, const std::vector<ColumnBlock>& blocks, Float4 force) {
    variant(blocks.data(), blocks.data() + blocks.size(), force, {value, touched});
  }
  friend bool operator==(const Sums& a, const Sums& b) {
    return std::memcmp(a.value, b.value, sizeof a.value) == 0 &&
           std::memcmp(a.touched, b.touched, sizeof a.touched) == 0;
  }
};

TEST_CASE("the fastest sum of blocks has the bits of the one of every processor, for any number of them") {
  if (fastest_add_blocks() == add_blocks) {
    MESSAGE("this processor has no faster one; nothing is compared");
    return;
  }
  std::mt19937_64 random(11);
  for (std::size_t count = 0; count < 40; ++count) {
    CAPTURE(count);
    Sums plain;
    Sums fastest;
    for (int column = 0; column < 20; ++column) {
      const std::vector<ColumnBlock> blocks = any_blocks(count, random);
      const Float4 force = {any_value(random), any_value(random), any_value(random), any_value(random)};
      plain.add(add_blocks, blocks, force);
      fastest.add(fastest_add_blocks(), blocks, force);
    }
    CHECK(plain == fastest);
  }
}

TEST_CASE("every value of a block counts, and only its own place is touched") {
  std::mt19937_64 random(12);
  for (const AddBlocks add : {AddBlocks{add_blocks}, fastest_add_blocks()}) {
    for (std::size_t count = 1; count < 10; ++count) {
      std::vector<ColumnBlock> blocks = any_blocks(count, random);
      for (ColumnBlock& block : blocks) {
        block = {};
      }
      for (std::size_t b = 0; b < count; ++b) {
        for (std::uint32_t k = 0; k < 9; ++k) {
          std::vector<ColumnBlock> one = blocks;
          const auto place = static_cast<std::uint32_t>(random() % places);
          for (ColumnBlock& block : one) {
            block.byte_offset = place * static_cast<std::uint32_t>(sizeof(Float4));
          }
          one[b].value[k] = 0x4040;  // 3
          Sums sums;
          sums.add(add, one, Float4{0.5F, 0.25F, 0.125F, 1.0F});
          for (std::uint32_t i = 0; i < places; ++i) {
            CHECK(sums.touched[i] == (i == place ? 1 : 0));
            for (std::uint32_t r = 0; r < 4; ++r) {
              const float force = k / 3 == 0 ? 0.5F : k / 3 == 1 ? 0.25F : 0.125F;
              CHECK(float{sums.value[i][r]} == (i == place && r == k % 3 ? 3 * force : 0.0F));
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
