#include "runtime/wavelet/wavelet.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

std::vector<std::uint32_t> domain_nodes(const ModelView& view) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t node = 0; node < view.node_count; ++node) {
    if (in_domain(view, node)) {
      nodes.push_back(node);
    }
  }
  return nodes;
}

// a field to be
template <unsigned N>
struct Coefficients {
  explicit Coefficients(const ModelView& model) : view(model), value(view.domain_count) {}
  void add(std::uint32_t node, Vector<N> coefficient) { value[domain_place(view, node)] = coefficient; }
  // by file index; the coefficients are checked to be zero again
  std::vector<Vector<N>> inverse(const Rooms<N>& rooms, std::uint32_t field_level) {
    std::vector<Vector<N>> x(view.node_count, Vector<N>{} + 1e30F);
    inverse_transform<N>(view, rooms.offsets, {view.levels - 1, field_level}, value.data(), x.data());
    CHECK(std::all_of(value.begin(), value.begin() + domain_up_to(view, field_level), is_zero<N>));
    return x;
  }
  const ModelView& view;
  std::vector<Vector<N>> value;
};

// takes what the blocks of node i of a level predict from it
template <unsigned N>
void subtract_blocks(const ModelView& view, const LevelView& level, std::uint32_t i,
                     std::vector<std::array<double, N>>& d) {
  for (std::uint32_t k = 0; k < N * N * level.predictions.terms; ++k) {
    const std::size_t term = std::size_t{level.predictions.terms} * i + k / (N * N);
    const double weight = stored_weight<N>(level.predictions, term, k % (N * N)) / 4096.0;
    const auto& from = d[domain_node(view, stored_source(level.predictions, term))];
    d[level.node_begin + i][k % N] -= weight * from[k % (N * N) / N];
  }
}

TEST_CASE_TEMPLATE("the inverse transform undoes the definition's forward transform", Components, One, Three) {
  constexpr unsigned N = Components::value;
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("linear") { kind = layout::Wavelet::linear; }
  SUBCASE("lifted butterfly") { kind = layout::Wavelet::lifted_butterfly; }
  SUBCASE("butterfly") { kind = layout::Wavelet::butterfly; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  const TestModel model({.components = N, .levels = 5, .wavelet = kind, .touchable_above = 0.95});
  const ModelView& view = model.view();
  const Rooms<N> rooms(view);
  std::mt19937_64 random(2);
  std::vector<std::array<double, N>> x(view.node_count);
  for (const std::uint32_t node : domain_nodes(view)) {
    for (double& value : x[node]) {
      value = static_cast<double>(random() >> 11) * 0x1p-53;
    }
  }
  auto d = x;
  for (std::uint32_t q = view.levels - 1; q > 0; --q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      subtract_blocks<N>(view, level, i, d);
      for (std::size_t r = 0; level.predictions.weight == nullptr && r < N; ++r) {
        d[level.node_begin + i][r] -= 0.5 * (d[level.refinement[i].parent[0]][r] + d[level.refinement[i].parent[1]][r]);
        if (level.stencils == nullptr || level.stencils[i].wing[0] == layout::none) continue;
        for (const std::uint32_t wing : level.stencils[i].wing) d[level.node_begin + i][r] -= d[wing][r] / 8;
        for (const std::uint32_t outer : level.stencils[i].outer) d[level.node_begin + i][r] += d[outer][r] / 16;
      }
    }
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (std::size_t r = 0; r < 2 * N; ++r) {
        d[level.refinement[i].parent[r / N]][r % N] +=
            double{level.refinement[i].lift[r / N]} * d[level.node_begin + i][r % N];
      }
    }
  }
  Coefficients<N> coefficients(view);
  for (const std::uint32_t node : domain_nodes(view)) {
    float of_node[N];
    std::copy(d[node].begin(), d[node].end(), of_node);
    coefficients.add(node, load_vector<N>(of_node));
  }
  const std::vector<Vector<N>> field = coefficients.inverse(rooms, view.levels - 1);
  for (std::uint32_t node = 0; node < view.node_count; ++node) {
    for (std::size_t r = 0; r < N; ++r) {
      CHECK(std::abs(double{component(field[node], r)} - x[node][r]) <= 8 * view.levels * 0x1p-24);
    }
    CHECK(is_padded(field[node]));
  }
}

TEST_CASE("a body predicts with blocks in the fastest form") {
  const TestModel model({.levels = 3, .wavelet = layout::Wavelet::equilibrated});
  const PlacedBody placed(model.view());
  CHECK((placed.body->offsets.predict_blocks == fastest_predict_blocks<3>()));
}

TEST_CASE_TEMPLATE("details above the field level are interpolated", Components, One, Three) {
  constexpr unsigned N = Components::value;
  const TestModel model({.components = N, .levels = 4, .touchable_above = 0.95});
  const ModelView& view = model.view();
  const Rooms<N> rooms(view);
  Coefficients<N> coarse(view);
  for (std::uint32_t i = 0; i < view.level[0].counts->domain_count; ++i) {
    coarse.add(i, components(Vector<N>{} + (1.0F + static_cast<float>(i))));
  }
  const std::vector<Vector<N>> field = coarse.inverse(rooms, 0);
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      const std::uint32_t* parent = level.refinement[i].parent;
      for (std::size_t r = 0; r < N; ++r) {
        const float sum = component(field[parent[0]], r) + component(field[parent[1]], r);
        CHECK(component(field[level.node_begin + i], r) == 0.5F * sum);
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
