#include "runtime/wavelet/block_predictions.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "runtime/wavelet/prediction.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t coarse = 11;
constexpr std::uint32_t odd = 7;

// a level of 7 domain nodes, two fixed ones after them, predicted from 11 coarser nodes with arbitrary weights
struct Level {
  explicit Level(std::uint32_t terms) : weight(18 * std::size_t{odd} * terms + 16), sources(std::size_t{odd} * terms) {
    std::mt19937_64 random(terms);
    for (std::size_t k = 0; k < 9 * sources.size(); ++k) {
      const auto value = static_cast<std::int16_t>(static_cast<int>(random() % 65535) - 32767);
      std::memcpy(weight.data() + 2 * k, &value, sizeof value);
    }
    for (std::uint32_t& source : sources) {
      source = static_cast<std::uint32_t>(random() % coarse * sizeof(Float4));
    }
    counts.node_count = odd + 2;
    counts.domain_count = odd;
    view.counts = &counts;
    view.node_begin = coarse;
    view.predictions = {.terms = terms, .index_bytes = 2, .index = nullptr, .weight = weight.data()};
    for (std::uint32_t i = 0; i < coarse; ++i) {
      const auto number = [&] { return static_cast<float>(static_cast<int>(random() >> 40) - (1 << 23)) * 0x1p-30F; };
      x.push_back(Float4{number(), number(), number(), 0.0F});
    }
    x[3] = Float4{1e-42F, -1e-40F, 1e-38F, 0.0F};  // denormal numbers are numbers like others
    x.resize(coarse + odd + 2, splat(1e30F));
  }

  std::vector<std::byte> weight;
  std::vector<std::uint32_t> sources;
  layout::Level counts{};
  LevelView view;
  std::vector<Float4> x;
};

TEST_CASE("nodes are predicted from their terms, other nodes are left alone, on every processor the same bits") {
  for (std::uint32_t terms = 0; terms <= layout::most_prediction_terms; ++terms) {
    CAPTURE(terms);
    Level level(terms);
    auto x = level.x;
    predict_blocks<3>(level.view, level.sources.data(), x.data());
    CHECK(std::memcmp(x.data(), level.x.data(), coarse * sizeof(Float4)) == 0);
    CHECK(std::memcmp(&x[coarse + odd], &level.x[coarse + odd], 2 * sizeof(Float4)) == 0);
    for (std::uint32_t i = 0; i < odd; ++i) {
      double sum[3] = {};
      double size = 0;
      for (std::uint32_t k = 0; k < terms; ++k) {
        const std::size_t term = std::size_t{terms} * i + k;
        for (std::size_t e = 0; e < 9; ++e) {
          std::int16_t value;
          std::memcpy(&value, level.weight.data() + 2 * (9 * term + e), sizeof value);
          const double part = value / 4096.0 * double{level.x[level.sources[term] / sizeof(Float4)][e / 3]};
          sum[e % 3] += part;
          size += std::abs(part);
        }
      }
      for (std::size_t r = 0; r < 3; ++r) {
        CHECK(std::abs(double{x[coarse + i][r]} - sum[r]) <= 1e-6 * size);
      }
      CHECK(float{x[coarse + i][3]} == 0);
    }
    auto fastest = level.x;
    fastest_predict_blocks<3>()(level.view, level.sources.data(), fastest.data());
    CHECK(std::memcmp(fastest.data(), x.data(), x.size() * sizeof(Float4)) == 0);
  }
}

}  // namespace
}  // namespace greenloop
