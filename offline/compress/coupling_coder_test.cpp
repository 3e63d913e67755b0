#include "offline/compress/coupling_coder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace greenloop::offline {
namespace {

constexpr std::size_t rows = 40, columns = 30;
constexpr int averages = 0, parents = 1, same = 2;
constexpr double largest_value[3] = {32767, 127, 7};

// blocks of sizes from far below a quantum to far above the medium layer's range
CouplingCandidates candidates(bool strict_half) {
  std::mt19937_64 random(11);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  CouplingCandidates result;
  result.rows = strict_half ? columns : rows;
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::size_t i = 0; i < (strict_half ? j : rows); ++i) {
      const double size = std::pow(10.0, -5 + 5 * uniform());
      double energy = 0;
      for (int k = 0; k < 9; ++k) {
        result.value.push_back(static_cast<float>(size * (2 * uniform() - 1)));
        energy += static_cast<double>(result.value.back()) * static_cast<double>(result.value.back());
      }
      result.row.push_back(static_cast<std::uint32_t>(i));
      result.norm.push_back(static_cast<float>(std::sqrt(energy / 3)));
    }
    result.begin.push_back(result.row.size());
  }
  return result;
}

CompliancePyramid pyramid() {
  CompliancePyramid result;
  const Eigen::Matrix3d diagonal = 4e-6 * Eigen::Vector3d(1, 4, 9).asDiagonal().toDenseMatrix();
  const Eigen::Matrix3d conditional = 1e-6 * Eigen::Vector3d(1, 4, 9).asDiagonal().toDenseMatrix();
  result.levels.resize(3);
  result.levels[0].averages.assign(columns, {diagonal, conditional, "average", 0});
  result.levels[0].partner[same] = candidates(true);
  for (std::size_t level = 1; level < 3; ++level) {
    result.levels[level].details.assign(columns, {diagonal, conditional, "detail", 0});
    for (const int partner : {averages, parents, same}) {
      if (level > 1 || partner != parents) result.levels[level].partner[partner] = candidates(partner == same);
    }
  }
  return result;
}

ModelData encoded(const CompliancePyramid& from, const Encoding& encoding) {
  ModelData model;
  model.levels.resize(from.levels.size());
  encode_couplings(from, encoding, model);
  return model;
}

constexpr std::size_t absent = std::numeric_limits<std::size_t>::max();

std::size_t find(const CouplingsData& data, std::size_t column, std::uint32_t row) {
  for (std::size_t b = data.begin[column]; b < data.begin[column + 1]; ++b) {
    if (data.index[b] == row) return b;
  }
  return absent;
}

double largest(const float* value) {
  double most = 0;
  for (int k = 0; k < 9; ++k) most = std::max(most, std::abs(static_cast<double>(value[k])));
  return most;
}

TEST_CASE("every block above the threshold stands once, in the fewest bits that hold it, within half a quantum") {
  const auto from = pyramid();
  const Encoding encoding{.threshold = 0.002, .quantum = 0.001};
  const auto model = encoded(from, encoding);
  std::array<std::size_t, 3> found{};
  std::size_t dropped = 0;
  for (std::size_t level = 1; level < 3; ++level) {
    for (const int partner : {averages, parents, same}) {
      if (level == 1 && partner == parents) continue;
      const auto& source = from.levels[level].partner[partner];
      const auto& layers = model.levels[level].couplings[static_cast<std::size_t>(partner)];
      for (std::size_t j = 0; j < columns; ++j) {
        for (std::size_t b = source.begin[j]; b < source.begin[j + 1]; ++b) {
          const float* value = source.value.data() + 9 * b;
          std::size_t times = 0;
          for (std::size_t layer = 0; layer < 3; ++layer) {
            const auto& data = layers[layer];
            const std::size_t at = find(data, j, source.row[b]);
            if (at == absent) continue;
            ++times;
            ++found[layer];
            const auto quantum = static_cast<double>(data.quantum);
            double most = 0;
            for (std::size_t k = 0; k < 9; ++k) {
              const double q = data.value[9 * at + k];
              CHECK(std::abs(q * quantum - static_cast<double>(value[k])) <= 0.5000001 * quantum);
              most = std::max(most, std::abs(q));
            }
            CHECK(most <= largest_value[layer]);
            if (layer < 2) CHECK(largest(value) >= (largest_value[layer + 1] + 0.4999) * encoding.quantum);
          }
          const bool keeps = static_cast<double>(source.norm[b]) >= encoding.threshold;
          CHECK(times == (keeps ? 1 : 0));
          dropped += keeps ? 0 : 1;
        }
      }
    }
  }
  for (const std::size_t count : found) CHECK(count > 100);
  CHECK(dropped > 100);
}

TEST_CASE("layers have their bits, one quantum, and rows that increase") {
  const Encoding encoding{.threshold = 0.001, .quantum = 0.0005};
  const auto model = encoded(pyramid(), encoding);
  for (std::size_t level = 1; level < 3; ++level) {
    for (const auto& partner : model.levels[level].couplings) {
      constexpr std::uint32_t bits[3] = {16, 8, 4};
      for (std::size_t layer = 0; layer < 3; ++layer) {
        const auto& data = partner[layer];
        if (level == 1 && &partner == &model.levels[level].couplings[parents]) {
          CHECK(data.begin.empty());  // no such section
          continue;
        }
        CHECK(data.value_bits == bits[layer]);
        CHECK(data.quantum == static_cast<float>(encoding.quantum));
        REQUIRE(data.begin.size() == columns + 1);
        CHECK(data.begin.back() == data.index.size());
        CHECK(data.value.size() == 9 * data.index.size());
        for (std::size_t j = 0; j < columns; ++j) {
          for (std::size_t b = data.begin[j] + 1; b < data.begin[j + 1]; ++b) CHECK(data.index[b - 1] < data.index[b]);
        }
      }
    }
  }
}

TEST_CASE("strong couplings take a larger quantum rather than overflow") {
  const auto model = encoded(pyramid(), {.threshold = 1e-6, .quantum = 1e-7});
  const auto& layers = model.levels[2].couplings[averages];
  CHECK(layers[0].quantum > 1e-5F);  // the largest block is nearly 1
  CHECK(layers[1].quantum == 1e-7F);
  int most = 0;
  for (const std::int16_t q : layers[0].value) most = std::max(most, std::abs(int{q}));
  CHECK(most == 32767);
}

TEST_CASE("values at the edge of a layer's range never leave it") {
  std::size_t edges = 0;
  for (int i = 0; i < 3000; ++i) {
    const double quantum = 1e-3 * (1 + i * 1e-4);
    CompliancePyramid from;
    from.levels.resize(2);
    auto& couplings = from.levels[1].partner[averages];
    couplings.rows = 1;
    for (const double edge : {7.5 * quantum, 127.5 * quantum}) {
      auto value = static_cast<float>(edge);
      for (int steps = 0; steps < 4; ++steps, value = std::nextafter(value, 0.0F)) {
        couplings.row.push_back(0);
        couplings.norm.push_back(1);
        couplings.value.insert(couplings.value.end(), 9, value);
        couplings.begin.push_back(couplings.row.size());
      }
    }
    const auto model = encoded(from, {.threshold = 1e-3, .quantum = quantum});
    const auto& layers = model.levels[1].couplings[averages];
    for (const std::int16_t q : layers[1].value) {
      if (q > 127) FAIL("medium ", q, " with quantum ", quantum);
      edges += q == 127 ? 1 : 0;
    }
    for (const std::int16_t q : layers[2].value) {
      if (q > 7) FAIL("weak ", q, " with quantum ", quantum);
      edges += q == 7 ? 1 : 0;
    }
  }
  CHECK(edges > 1000);
}

TEST_CASE("blocks that round to zero are not stored") {
  const auto model = encoded(pyramid(), {.threshold = 1e-6, .quantum = 0.01});
  for (const auto& data : model.levels[2].couplings[averages]) {
    for (std::size_t b = 0; b < data.index.size(); ++b) {
      CHECK(std::any_of(data.value.begin() + static_cast<std::ptrdiff_t>(9 * b),
                        data.value.begin() + static_cast<std::ptrdiff_t>(9 * (b + 1)),
                        [](std::int16_t q) { return q != 0; }));
    }
  }
}

TEST_CASE("level 0 keeps every block in 16 bits, whatever the threshold") {
  const auto from = pyramid();
  const auto model = encoded(from, {.threshold = 0.4, .quantum = 0.2});
  const auto& data = model.levels[0].couplings[same][0];
  const auto& source = from.levels[0].partner[same];
  CHECK(data.value_bits == 16);
  CHECK(data.index.empty());
  CHECK(std::equal(data.begin.begin(), data.begin.end(), source.begin.begin(), source.begin.end()));
  REQUIRE(data.value.size() == source.value.size());
  int most = 0;
  for (std::size_t k = 0; k < data.value.size(); ++k) {
    const auto quantum = static_cast<double>(data.quantum);
    CHECK(std::abs(data.value[k] * quantum - static_cast<double>(source.value[k])) <= 0.5000001 * quantum);
    most = std::max(most, std::abs(int{data.value[k]}));
  }
  CHECK(most == 32767);
  for (std::size_t layer = 1; layer < 3; ++layer) CHECK(model.levels[0].couplings[same][layer].begin.empty());
}

TEST_CASE("scales are stored as root and scaled diagonal") {
  const auto model = encoded(pyramid(), {.threshold = 0.1, .quantum = 0.05});
  CHECK(model.levels[0].details.empty());
  REQUIRE(model.levels[0].averages.size() == columns);
  REQUIRE(model.levels[2].details.size() == columns);
  CHECK(model.levels[2].averages.empty());
  const auto& scale = model.levels[2].details[3];
  const float root[6] = {1e-3F, 0, 0, 2e-3F, 0, 3e-3F}, diagonal[6] = {4, 0, 0, 4, 0, 4};
  for (int k = 0; k < 6; ++k) {
    CHECK(std::abs(scale.root[k] - root[k]) < 1e-9F);
    CHECK(std::abs(scale.diagonal[k] - diagonal[k]) < 1e-5F);
  }
}

}  // namespace
}  // namespace greenloop::offline
