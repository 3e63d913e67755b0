#include "runtime/wavelet/block_predictions.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "runtime/testing/rooms.hpp"
#include "runtime/wavelet/prediction.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t coarse = 11;
constexpr std::uint32_t odd = 7;
constexpr double least = std::numeric_limits<float>::denorm_min();

// a level of 7 domain nodes, two fixed ones after them, predicted from 11 coarser nodes with arbitrary weights
template <unsigned N>
struct Level {
  explicit Level(std::uint32_t terms)
      : weight(2 * N * N * std::size_t{odd} * terms + 16), sources(std::size_t{odd} * terms) {
    std::mt19937_64 random(terms);
    for (std::size_t k = 0; k < N * N * sources.size(); ++k) {
      const auto value = static_cast<std::int16_t>(static_cast<int>(random() % 65535) - 32767);
      std::memcpy(weight.data() + 2 * k, &value, sizeof value);
    }
    for (std::uint32_t& source : sources) {
      source = static_cast<std::uint32_t>(random() % coarse * sizeof(Vector<N>));
    }
    counts.node_count = odd + 2;
    counts.domain_count = odd;
    view.counts = &counts;
    view.node_begin = coarse;
    view.predictions = {.terms = terms, .index_bytes = 2, .index = nullptr, .weight = weight.data()};
    for (std::uint32_t i = 0; i < coarse; ++i) {
      const auto number = [&] { return static_cast<float>(static_cast<int>(random() >> 40) - (1 << 23)) * 0x1p-30F; };
      const float numbers[] = {number(), number(), number()};
      x.push_back(load_vector<N>(numbers));
    }
    const float denormal[] = {1e-42F, -1e-40F, 1e-38F};  // numbers like others
    x[3] = load_vector<N>(denormal);
    x.resize(coarse + odd + 2, Vector<N>{} + 1e30F);
  }

  std::vector<std::byte> weight;
  std::vector<std::uint32_t> sources;
  layout::Level counts{};
  LevelView view;
  std::vector<Vector<N>> x;
};

TEST_CASE_TEMPLATE(
    "nodes are predicted from their terms and take their details, other nodes are left alone, on every "
    "processor the same bits",
    Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (std::uint32_t terms = 0; terms <= layout::most_prediction_terms; ++terms) {
    CAPTURE(terms);
    Level<N> level(terms);
    auto x = level.x;
    predict_blocks<N>(level.view, level.sources.data(), nullptr, x.data());
    CHECK(std::memcmp(x.data(), level.x.data(), coarse * sizeof(Vector<N>)) == 0);
    CHECK(std::memcmp(&x[coarse + odd], &level.x[coarse + odd], 2 * sizeof(Vector<N>)) == 0);
    for (std::uint32_t i = 0; i < odd; ++i) {
      double sum[N] = {};
      double size = 0;
      for (std::uint32_t k = 0; k < terms; ++k) {
        const std::size_t term = std::size_t{terms} * i + k;
        for (std::size_t e = 0; e < N * N; ++e) {
          std::int16_t value;
          std::memcpy(&value, level.weight.data() + 2 * (N * N * term + e), sizeof value);
          const double part =
              value / 4096.0 * double{component(level.x[level.sources[term] / sizeof(Vector<N>)], e / N)};
          sum[e % N] += part;
          size += std::abs(part);
        }
      }
      for (std::size_t r = 0; r < N; ++r) {
        CHECK(std::abs(double{component(x[coarse + i], r)} - sum[r]) <= 1e-6 * size + least);
      }
      CHECK(is_padded(x[coarse + i]));
    }
    auto fastest = level.x;
    fastest_predict_blocks<N>()(level.view, level.sources.data(), nullptr, fastest.data());
    CHECK(std::memcmp(fastest.data(), x.data(), x.size() * sizeof(Vector<N>)) == 0);

    const std::vector<Vector<N>> given(level.x.begin(), level.x.begin() + odd);
    for (const PredictBlocks<N> predict : {PredictBlocks<N>{predict_blocks<N>}, fastest_predict_blocks<N>()}) {
      auto detailed = level.x;
      auto details = given;
      predict(level.view, level.sources.data(), details.data(), detailed.data());
      for (std::uint32_t i = 0; i < odd; ++i) {
        detailed[coarse + i] = added(detailed[coarse + i], -given[i]);
      }
      for (std::size_t n = 0; n < x.size() * N; ++n) {
        CHECK(component(detailed[n / N], n % N) == doctest::Approx(component(x[n / N], n % N)).epsilon(1e-5));
      }
      const std::vector<Vector<N>> none(odd, Vector<N>{});
      CHECK(std::memcmp(details.data(), none.data(), odd * sizeof(Vector<N>)) == 0);
    }
  }
}

}  // namespace
}  // namespace greenloop
