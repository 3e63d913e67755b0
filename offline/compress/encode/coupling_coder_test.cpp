#include "offline/compress/encode/coupling_coder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <stdexcept>

#include "offline/compress/testing/test_body.hpp"

namespace greenloop::offline {
namespace {

using test::Scalars;
using test::Vectors;

constexpr std::size_t columns = 30, levels = 3;
constexpr double own_size = 2;  // root of the scaled diagonal

double largest_value(std::uint32_t layer) { return std::ldexp(1, static_cast<int>(layout::value_bits[layer]) - 1) - 1; }

// blocks of sizes from far below a quantum to far above the 16 bits' range
template <unsigned N>
CouplingCandidates<N> candidates(std::size_t first) {
  std::mt19937_64 random(11 + first);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  CouplingCandidates<N> result;
  for (std::size_t j = first; j < first + columns; ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const double size = std::pow(10.0, -5 + 7 * uniform());
      double energy = 0;
      for (unsigned k = 0; k < block_numbers<N>; ++k) {
        result.value.push_back(static_cast<float>(size * (2 * uniform() - 1)));
        energy += static_cast<double>(result.value.back()) * static_cast<double>(result.value.back());
      }
      result.row.push_back(static_cast<std::uint32_t>(i));
      result.norm.push_back(static_cast<float>(std::sqrt(energy / N)));
    }
    result.begin.push_back(result.row.size());
  }
  return result;
}

template <unsigned N>
WaveletCompliance<N> compliance() {
  WaveletCompliance<N> result;
  const SquareMatrix<3> vectors = 1e-6 * Eigen::Vector3d(1, 4, 9).asDiagonal().toDenseMatrix();
  const SquareMatrix<N> conditional = vectors.topLeftCorner<N, N>();
  for (std::size_t level = 0; level < levels; ++level) {
    for (std::size_t j = 0; j < columns; ++j) {
      result.scales.emplace_back(own_size * own_size * conditional, conditional, result.scales.size());
    }
    result.couplings.push_back(candidates<N>(level * columns));
  }
  return result;
}

template <unsigned N>
ModelData encoded(const WaveletCompliance<N>& from, const Encoding& encoding) {
  ModelData model;
  model.levels.resize(from.couplings.size());
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

template <unsigned N>
double largest(const float* value) {
  double most = 0;
  for (unsigned k = 0; k < block_numbers<N>; ++k) most = std::max(most, std::abs(static_cast<double>(value[k])));
  return most;
}

// the layer that candidate b of column j stands in, checked; absent if it is dropped
template <unsigned N>
std::size_t check_block(const CouplingCandidates<N>& source, std::size_t b, const LevelData& level, std::size_t j,
                        const layout::Info& info, const Encoding& encoding) {
  const float* value = source.value.data() + block_numbers<N> * b;
  const auto norm = static_cast<double>(source.norm[b]);
  std::array<double, block_numbers<N>> left{};
  std::copy_n(value, left.size(), left.begin());
  std::size_t found = absent;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const auto& data = level.couplings[layer];
    const std::size_t at = find(data, j, source.row[b]);
    if (at == absent) continue;
    const auto quantum = static_cast<double>(info.quantum[layer]);
    double most = 0;
    for (std::size_t k = 0; k < block_numbers<N>; ++k) {
      const double q = data.value[block_numbers<N> * at + k];
      left[k] -= q * quantum;
      CHECK(std::abs(left[k]) <= 0.5000001 * quantum);
      most = std::max(most, std::abs(q));
    }
    CHECK(most <= largest_value(layer));
    if (found == 0) continue;  // this is what is left of a large one
    CHECK(found == absent);
    found = layer;
    const std::uint32_t bits = layout::value_bits[layer];
    const double too_few = layer == 0 ? 32767 : bits == 16 ? 127 : bits == 8 ? 7 : 0;
    CHECK(largest<N>(value) >= (too_few + 0.4999) * encoding.quantum);
  }
  CHECK((found == absent) == (norm < encoding.threshold));
  for (const double value_left : left) {
    if (found != absent) CHECK(std::abs(value_left) <= 0.5000001 * encoding.quantum);
  }
  return found;
}

TEST_CASE_TEMPLATE(
    "every block above the threshold stands in the fewest bits that hold it, within half a quantum, however large", T,
    Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto from = compliance<N>();
  std::array<std::size_t, layout::layers> found{};
  std::size_t dropped = 0;
  const Encoding encoding{.threshold = 0.002, .quantum = 0.001};
  const auto model = encoded(from, encoding);
  for (std::uint32_t layer = 1; layer < layout::layers; ++layer) {
    CHECK(model.info.quantum[layer] == static_cast<float>(encoding.quantum));
  }
  CHECK(model.info.quantum[0] > model.info.quantum[1]);  // the largest block is nearly 100
  for (std::size_t level = 0; level < levels; ++level) {
    for (std::size_t j = 0; j < columns; ++j) {
      const auto& source = from.couplings[level];
      for (std::size_t b = source.begin[j]; b < source.begin[j + 1]; ++b) {
        const std::size_t layer = check_block(source, b, model.levels[level], j, model.info, encoding);
        if (layer == absent) {
          ++dropped;
        } else {
          ++found[layer];
        }
      }
    }
  }
  for (const std::size_t count : found) CHECK(count > 50);
  CHECK(dropped > 100);
}

TEST_CASE_TEMPLATE("rows increase within a column, in every layer", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto model = encoded(compliance<N>(), {.threshold = 0.001, .quantum = 0.0005});
  for (const auto& level : model.levels) {
    for (const auto& data : level.couplings) {
      REQUIRE(data.begin.size() == columns + 1);
      CHECK(data.begin.back() == data.index.size());
      CHECK(data.value.size() == block_numbers<N> * data.index.size());
      for (std::size_t j = 0; j < columns; ++j) {
        for (std::size_t b = data.begin[j] + 1; b < data.begin[j + 1]; ++b) CHECK(data.index[b - 1] < data.index[b]);
      }
    }
  }
}

TEST_CASE_TEMPLATE("values at the edge of a layer's range never leave it", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  std::array<std::size_t, layout::layers> edges{};
  for (int i = 0; i < 3000; ++i) {
    const double quantum = 1e-3 * (1 + i * 1e-4);
    WaveletCompliance<N> from;
    const SquareMatrix<N> unit = SquareMatrix<N>::Identity();
    from.couplings.resize(1);
    auto& couplings = from.couplings[0];
    for (const double edge : {7.5 * quantum, 127.5 * quantum, 32767.5 * quantum}) {
      auto value = static_cast<float>(edge);
      for (int steps = 0; steps < 4; ++steps, value = std::nextafter(value, 0.0F)) {
        from.scales.emplace_back(unit, unit, from.scales.size());
        couplings.row.push_back(0);
        couplings.norm.push_back(1);
        couplings.value.insert(couplings.value.end(), block_numbers<N>, value);
        couplings.begin.push_back(couplings.row.size());
      }
    }
    const auto model = encoded(from, {.threshold = 1e-3, .quantum = quantum});
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      for (const std::int16_t q : model.levels[0].couplings[layer].value) {
        if (q > largest_value(layer)) FAIL("layer ", layer, " has ", q, " with quantum ", quantum);
        edges[layer] += q == largest_value(layer) ? 1 : 0;
      }
    }
  }
  for (const std::uint32_t layer : {1U, 2U, 3U}) CHECK(edges[layer] > 1000);
}

TEST_CASE_TEMPLATE("blocks that round to zero are not stored", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto model = encoded(compliance<N>(), {.threshold = 1e-6, .quantum = 0.01});
  for (const auto& data : model.levels[2].couplings) {
    for (std::size_t b = 0; b < data.index.size(); ++b) {
      CHECK(std::any_of(data.value.begin() + static_cast<std::ptrdiff_t>(block_numbers<N> * b),
                        data.value.begin() + static_cast<std::ptrdiff_t>(block_numbers<N> * (b + 1)),
                        [](std::int16_t q) { return q != 0; }));
    }
  }
}

TEST_CASE_TEMPLATE("scales are stored as root and scaled diagonal", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const ModelData model = encoded(compliance<N>(), {.threshold = 0.1, .quantum = 0.05});
  REQUIRE(model.levels[2].scales.of<N>().size() == columns);
  const auto& scale = model.levels[2].scales.of<N>()[3];
  constexpr float rounding = N == 3 ? 1e-9F : 2e-9F;  // 2^-19 of the number, and less of a matrix
  const float root[6] = {1e-3F, 0, 0, 2e-3F, 0, 3e-3F}, diagonal[6] = {4, 0, 0, 4, 0, 4};
  for (unsigned k = 0; k < N * (N + 1) / 2; ++k) {
    CHECK(std::abs(scale.root[k] - root[k]) < rounding);
    CHECK(std::abs(scale.diagonal[k] - diagonal[k]) < 1e-5F);
  }
}

TEST_CASE_TEMPLATE("a value beyond what can be stored is refused with the remedy", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  auto from = compliance<N>();
  from.couplings[1].value[9] = -32767;
  CHECK(encoded(from, {.threshold = 0.001, .quantum = 0.0005}).info.quantum[0] == 1);
  from.couplings[1].value[9] = -32768;
  CHECK_THROWS_WITH_AS((void)encoded(from, {.threshold = 0.001, .quantum = 0.0005}), doctest::Contains("too thin"),
                       std::runtime_error);
}

// whole numbers of 2^-digits, zeros without a sign
bool is_multiple(std::span<const float> matrix, int digits) {
  return std::all_of(std::begin(matrix), std::end(matrix), [&](float value) {
    const double units = std::ldexp(static_cast<double>(value), digits);
    return units == std::round(units) && (value != 0 || !std::signbit(value));
  });
}

TEST_CASE("stored scales have few digits and are as exact as the couplings beside them") {
  Eigen::Matrix3d diagonal, conditional;
  diagonal << 9, 2, -1e-9, 2, 7, -1, -1e-9, -1, 5;
  conditional << 2.3, 0, -1e-9, 0, 1.7, -0.3, -1e-9, -0.3, 1.1;
  const CoefficientScale<3> scale(diagonal, conditional, 0);
  constexpr double quantum = 0.01;
  const layout::Scale<3> stored = scale.stored(quantum);
  CHECK(is_multiple(stored.root, 19));  // the inverse root's norm is 1.5
  CHECK(is_multiple(stored.diagonal, 9));
  CHECK((symmetric_matrix(stored.root) - scale.root()).cwiseAbs().maxCoeff() < 0x1p-19);
  CHECK((symmetric_matrix(stored.diagonal) - scale.diagonal()).cwiseAbs().maxCoeff() < 0.125 * quantum);

  const CoefficientScale<1> one(SquareMatrix<1>(9.0), SquareMatrix<1>(2.3), 0);
  const layout::Scale<1> stored_one = one.stored(quantum);
  CHECK(is_multiple(stored_one.root, 18));  // the inverse root is 0.66
  CHECK(is_multiple(stored_one.diagonal, 9));
  CHECK(std::abs(static_cast<double>(stored_one.root[0]) - std::sqrt(2.3)) < 0x1p-18);
  CHECK(std::abs(static_cast<double>(stored_one.diagonal[0]) - 9 / 2.3) < 0.125 * quantum);
}

}  // namespace
}  // namespace greenloop::offline
