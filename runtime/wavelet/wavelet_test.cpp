#include "runtime/wavelet/wavelet.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "runtime/testing/placed_body.hpp"
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
struct Coefficients {
  explicit Coefficients(const ModelView& model) : view(model), value(view.domain_count) {}
  void add(std::uint32_t node, Float4 coefficient) { value[domain_place(view, node)] = coefficient; }
  // by file index; the coefficients are checked to be zero again
  std::vector<Float4> inverse(const PlacedBody& placed, std::uint32_t field_level) {
    std::vector<Float4> x(view.node_count, splat(1e30F));
    inverse_transform<3>(view, placed.body->offsets, {view.levels - 1, field_level}, value.data(), x.data());
    CHECK(std::all_of(value.begin(), value.begin() + domain_up_to(view, field_level),
                      [](Float4 v) { return v[0] == 0 && v[1] == 0 && v[2] == 0 && v[3] == 0; }));
    return x;
  }
  const ModelView& view;
  std::vector<Float4> value;
};

// takes what the blocks of node i of a level predict from it
void subtract_blocks(const ModelView& view, const LevelView& level, std::uint32_t i,
                     std::vector<std::array<double, 3>>& d) {
  for (std::uint32_t k = 0; k < 9 * level.predictions.terms; ++k) {
    const std::size_t term = std::size_t{level.predictions.terms} * i + k / 9;
    const double weight = stored_weight<3>(level.predictions, term, k % 9) / 4096.0;
    d[level.node_begin + i][k % 3] -= weight * d[domain_node(view, stored_source(level.predictions, term))][k % 9 / 3];
  }
}

TEST_CASE("the inverse transform undoes the definition's forward transform") {
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("linear") { kind = layout::Wavelet::linear; }
  SUBCASE("lifted butterfly") { kind = layout::Wavelet::lifted_butterfly; }
  SUBCASE("butterfly") { kind = layout::Wavelet::butterfly; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  const TestModel model({.levels = 5, .wavelet = kind, .touchable_above = 0.95});
  const ModelView& view = model.view();
  const PlacedBody placed(view);
  std::mt19937_64 random(2);
  std::vector<std::array<double, 3>> x(view.node_count);
  for (const std::uint32_t node : domain_nodes(view)) {
    for (double& value : x[node]) {
      value = static_cast<double>(random() >> 11) * 0x1p-53;
    }
  }
  auto d = x;
  for (std::uint32_t q = view.levels - 1; q > 0; --q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      subtract_blocks(view, level, i, d);
      for (std::size_t r = 0; level.predictions.weight == nullptr && r < 3; ++r) {
        d[level.node_begin + i][r] -= 0.5 * (d[level.refinement[i].parent[0]][r] + d[level.refinement[i].parent[1]][r]);
        if (level.stencils == nullptr || level.stencils[i].wing[0] == layout::none) continue;
        for (const std::uint32_t wing : level.stencils[i].wing) d[level.node_begin + i][r] -= d[wing][r] / 8;
        for (const std::uint32_t outer : level.stencils[i].outer) d[level.node_begin + i][r] += d[outer][r] / 16;
      }
    }
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (std::size_t r = 0; r < 6; ++r) {
        d[level.refinement[i].parent[r / 3]][r % 3] +=
            double{level.refinement[i].lift[r / 3]} * d[level.node_begin + i][r % 3];
      }
    }
  }
  Coefficients coefficients(view);
  for (const std::uint32_t node : domain_nodes(view)) {
    const auto& of_node = d[node];
    coefficients.add(
        node, Float4{static_cast<float>(of_node[0]), static_cast<float>(of_node[1]), static_cast<float>(of_node[2])});
  }
  const std::vector<Float4> field = coefficients.inverse(placed, view.levels - 1);
  for (std::uint32_t node = 0; node < view.node_count; ++node) {
    for (std::size_t r = 0; r < 3; ++r) {
      CHECK(std::abs(double{field[node][r]} - x[node][r]) <= 8 * view.levels * 0x1p-24);
    }
    CHECK(float{field[node][3]} == 0);
  }
}

TEST_CASE("a body predicts with blocks in the fastest form") {
  const TestModel model({.levels = 3, .wavelet = layout::Wavelet::equilibrated});
  const PlacedBody placed(model.view());
  CHECK((placed.body->offsets.predict_blocks == fastest_predict_blocks<3>()));
}

TEST_CASE("details above the field level are interpolated") {
  const TestModel model({.levels = 4, .touchable_above = 0.95});
  const ModelView& view = model.view();
  const PlacedBody placed(view);
  Coefficients coarse(view);
  for (std::uint32_t i = 0; i < view.level[0].counts->domain_count; ++i) {
    coarse.add(i, components(splat(1.0F + static_cast<float>(i))));
  }
  const std::vector<Float4> field = coarse.inverse(placed, 0);
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      const std::uint32_t* parent = level.refinement[i].parent;
      CHECK(float{field[level.node_begin + i][1]} == 0.5F * (field[parent[0]][1] + field[parent[1]][1]));
    }
  }
}

}  // namespace
}  // namespace greenloop
