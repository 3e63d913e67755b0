// The coder and the models of bits and integers on it: what is written is read.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "formats/transport/adaptive_bit.hpp"
#include "formats/transport/adaptive_integer.hpp"
#include "formats/transport/float_bits.hpp"
#include "formats/transport/neighbours.hpp"
#include "formats/transport/range_coder.hpp"

namespace greenloop::transport {
namespace {

TEST_CASE("range coder: random bits of random probabilities come back, in as many bytes as they are worth") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::vector<std::pair<bool, std::uint32_t>> decisions(5000);
    double worth = 0;
    for (auto& [bit, probability] : decisions) {
      // the likelier the seed says, the longer the runs of 0xff and carries
      probability = 1 + static_cast<std::uint32_t>(random() % (seed % 2 == 0 ? 65535 : 20));
      bit = random() % 65536 < probability;
      worth -= std::log2((bit ? probability : 65536 - probability) / 65536.0) / 8;
    }
    RangeEncoder encoder;
    for (const auto& [bit, probability] : decisions) CHECK(encoder.code(bit, probability) == bit);
    const auto bytes = encoder.finish(0);
    CHECK(static_cast<double>(bytes.size()) < std::max(worth + 8, 5000.0 / most_decisions_per_byte + 2));
    RangeDecoder decoder(bytes);
    bool same = true;
    for (const auto& [bit, probability] : decisions) same = decoder.code(false, probability) == bit && same;
    CHECK(same);
  }
}

TEST_CASE("range coder: carries run through any number of held bytes") {
  for (int ones = 0; ones < 200; ++ones) {
    RangeEncoder encoder;
    const auto bit_at = [&](int i) { return i != ones; };
    for (int i = 0; i < 400; ++i) encoder.code(bit_at(i), i < ones ? 1 : 65535);
    const auto bytes = encoder.finish(0);
    RangeDecoder decoder(bytes);
    bool same = true;
    for (int i = 0; i < 400; ++i) same = decoder.code(false, i < ones ? 1 : 65535) == bit_at(i) && same;
    CHECK(same);
  }
}

TEST_CASE("range coder: a reader stops at the end of the bytes, and after more decisions than they can hold") {
  RangeEncoder encoder;
  for (int i = 0; i < 100; ++i) encoder.code_plain(static_cast<std::uint64_t>(i), 8);
  const auto bytes = encoder.finish(0);
  RangeDecoder decoder(bytes);
  for (int i = 0; i < 100; ++i) CHECK(decoder.code_plain(0, 8) == static_cast<std::uint64_t>(i));
  CHECK_THROWS_AS(decoder.code_plain(0, 64), DamagedPacket);

  const std::vector<std::byte> ones(8, std::byte{0xff});
  RangeDecoder endless(ones);
  const auto read_for_ever = [&] {
    for (std::uint64_t i = 0; i <= 8 * most_decisions_per_byte; ++i) endless.code(false, 1);
  };
  CHECK_THROWS_AS(read_for_ever(), DamagedPacket);
  CHECK_THROWS_AS(RangeDecoder(std::span(ones).first(3)), DamagedPacket);
}

TEST_CASE("logistic tables: monotone, symmetric, inverse to each other") {
  for (std::int32_t logit = -2047; logit < 2047; ++logit) {
    CHECK(squash(logit) <= squash(logit + 1));
    CHECK(squash(logit) + squash(-logit) == 65536);
  }
  CHECK(squash(0) == 32768);
  CHECK(squash(256) == doctest::Approx(65536 / (1 + std::exp(-1))).epsilon(1e-4));
  CHECK(squash(2047) == doctest::Approx(65536 / (1 + std::exp(-2047.0 / 256))).epsilon(1e-4));
  CHECK(squash(-100000) > 0);
  for (std::uint32_t p = 256; p <= 65280; p += 16) CHECK(std::abs(stretch(squash(stretch(p))) - stretch(p)) <= 4);
}

TEST_CASE("adaptive bits learn: nothing is spent on what never changes") {
  AdaptiveBit bit;
  MixedBits mixed(std::array<std::uint32_t, 2>{4, 3}, 2);
  RangeEncoder encoder;
  for (int i = 0; i < 20000; ++i) bit.code(encoder, true);
  for (std::uint32_t i = 0; i < 20000; ++i) {
    mixed.code(encoder, i % 4 == 1, std::array{i % 4, i % 3}, i % 2);  // the first context knows, the second does not
  }
  const auto bytes = encoder.finish(0);
  CHECK(bytes.size() < 320);  // a decoder takes 128 decisions from a byte at most: 40,000 in 313
  AdaptiveBit again;
  MixedBits mixed_again(std::array<std::uint32_t, 2>{4, 3}, 2);
  RangeDecoder decoder(bytes);
  bool same = true;
  for (int i = 0; i < 20000; ++i) same = again.code(decoder, false) && same;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    same = mixed_again.code(decoder, false, std::array{i % 4, i % 3}, i % 2) == (i % 4 == 1) && same;
  }
  CHECK(same);
}

TEST_CASE("adaptive integers: every size comes back") {
  std::vector<std::uint64_t> values{0, 1, 2, 3, 4, 7, 8, ~std::uint64_t{0}, std::uint64_t{1} << 63};
  std::mt19937_64 random(5);
  for (int i = 0; i < 2000; ++i) values.push_back(random() >> random() % 64);
  RangeEncoder encoder;
  AdaptiveInteger writing(3), reading(3);
  for (std::uint32_t i = 0; i < values.size(); ++i) writing.code(encoder, values[i], i % 3);
  const auto bytes = encoder.finish(0);
  RangeDecoder decoder(bytes);
  for (std::uint32_t i = 0; i < values.size(); ++i) CHECK(reading.code(decoder, 0, i % 3) == values[i]);
}

TEST_CASE("mixed integers: small, large and of both signs come back; larger ones than any written are refused") {
  std::vector<std::int32_t> values{0, 1, -1, 20, 21, 22, -20, -21, -22, 23, 65534, -65534};
  std::mt19937_64 random(6);
  for (int i = 0; i < 2000; ++i) values.push_back(static_cast<std::int32_t>(random() % 131069 >> random() % 17) - 40);
  const std::array<std::uint32_t, 2> sizes{5, 7};
  MixedInteger writing(sizes, 2), reading(sizes, 2);
  RangeEncoder encoder;
  const auto contexts = [](std::uint32_t i) { return std::array{i % 5, i % 7}; };
  for (std::uint32_t i = 0; i < values.size(); ++i) writing.code(encoder, values[i], contexts(i), i % 2);
  const auto bytes = encoder.finish(0);
  RangeDecoder decoder(bytes);
  for (std::uint32_t i = 0; i < values.size(); ++i) CHECK(reading.code(decoder, 0, contexts(i), i % 2) == values[i]);

  const std::vector<std::byte> always_one(64);
  RangeDecoder crafted(always_one);
  MixedInteger fresh(sizes, 2);
  CHECK_THROWS_AS(fresh.code(crafted, 0, contexts(0), 0), DamagedPacket);
}

TEST_CASE("signs interleave and come back") {
  for (const std::int64_t value : {INT64_C(0), INT64_C(-1), INT64_C(1), INT64_C(-2), INT64_MAX, INT64_MIN}) {
    CHECK(restore_sign(interleave_sign(value)) == value);
  }
  CHECK(interleave_sign(-1) == 1);
  CHECK(interleave_sign(1) == 2);
}

TEST_CASE("logarithmic scales: monotone, one step at a time") {
  for (std::uint64_t v = 0; v < 70000; ++v) {
    CHECK(quarter_octave(v + 1) - quarter_octave(v) <= 1);
    CHECK(half_octave(v + 1) - half_octave(v) <= 1);
  }
  CHECK(quarter_octave(~std::uint64_t{0}) == 251);
  CHECK(half_octave(~std::uint64_t{0}) == 127);
}

std::uint32_t bits(float number) { return std::bit_cast<std::uint32_t>(number); }

TEST_CASE("float bits: the order is that of the numbers, any pattern comes back") {
  const float numbers[] = {-3e38F, -2, -1, -1e-40F, 0, 1e-45F, 1, 1.0000001F, 3e38F};
  for (std::size_t i = 1; i < std::size(numbers); ++i) {
    CHECK(order_of(bits(numbers[i - 1])) < order_of(bits(numbers[i])));
  }
  std::mt19937_64 random(7);
  for (int i = 0; i < 10000; ++i) {
    const auto pattern = static_cast<std::uint32_t>(random());
    CHECK(bits_of_order(order_of(pattern)) == pattern);
  }
}

TEST_CASE("float bits: fixed numbers are exact as far as they reach") {
  const std::uint32_t exponent = exponent_of(bits(1.5F));
  CHECK(to_fixed(bits(1.5F), exponent) == INT64_C(3) << 39);
  CHECK(to_fixed(bits(-0.375F), exponent) == -(INT64_C(3) << 37));
  CHECK(to_fixed(bits(1e-30F), exponent) == 0);
  for (const float number : {1.5F, -0.375F, 0.0F, 1.9999999F, 0.001F, -1e-4F}) {
    CHECK(from_fixed(to_fixed(bits(number), exponent), exponent) == bits(number));
  }
  CHECK(from_fixed((to_fixed(bits(0.25F), exponent) + to_fixed(bits(1.0F), exponent)) / 2, exponent) == bits(0.625F));
}

TEST_CASE("neighbours: the nearest of the points before, by distance, peers and coarser ones apart") {
  std::mt19937_64 random(8);
  std::vector<GridPoint> points(120);  // fewer than are looked at on the curve, so that the answer is exact
  for (auto& point : points) {
    for (auto& coordinate : point) coordinate = static_cast<std::int32_t>(random() % 131071) - 65535;
  }
  const auto nearest = [&](std::uint32_t i, std::uint32_t begin, std::uint32_t end, std::size_t k) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> all;
    for (std::uint32_t j = begin; j < end; ++j) all.emplace_back(squared_distance(points[i], points[j]), j);
    std::sort(all.begin(), all.end());
    return k < all.size() ? all[k].second : no_neighbour;
  };
  for (const std::uint32_t first : {0U, 1U, 50U, 120U}) {
    const auto found = neighbours_before(points, first);
    REQUIRE(found.size() == points.size() - first);
    for (std::uint32_t i = first; i < points.size(); ++i) {
      for (std::size_t k = 0; k < peer_count; ++k) CHECK(found[i - first][k] == nearest(i, first, i, k));
      for (std::size_t k = 0; k < coarser_count; ++k) {
        CHECK(found[i - first][peer_count + k] == nearest(i, 0, first, k));
      }
    }
  }
  const std::vector<GridPoint> same(1000, GridPoint{1, 2, 3});
  CHECK(neighbours_before(same)[0][0] == no_neighbour);
  CHECK(neighbours_before(same)[999][0] < 999);
}

}  // namespace
}  // namespace greenloop::transport
