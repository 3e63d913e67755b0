#include "runtime/wavelet.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"

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

TEST_CASE("the inverse transform undoes the definition's forward transform") {
  const TestModel model({.levels = 5, .touchable_above = 0.95});
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
      for (std::size_t r = 0; r < 3; ++r) {
        d[level.node_begin + i][r] -= 0.5 * (d[level.refinement[i].parent[0]][r] + d[level.refinement[i].parent[1]][r]);
      }
    }
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (std::size_t r = 0; r < 6; ++r) {
        d[level.refinement[i].parent[r / 3]][r % 3] +=
            double{level.refinement[i].lift[r / 3]} * d[level.node_begin + i][r % 3];
      }
    }
  }
  std::vector<Float4> field(view.node_count);
  for (std::uint32_t node = 0; node < view.node_count; ++node) {
    for (std::size_t r = 0; r < 3; ++r) {
      field[node][r] = static_cast<float>(d[node][r]);
    }
  }
  inverse_transform(view, placed.body->lifting, view.levels - 1, field.data());
  for (std::uint32_t node = 0; node < view.node_count; ++node) {
    for (std::size_t r = 0; r < 3; ++r) {
      CHECK(std::abs(double{field[node][r]} - x[node][r]) <= 8 * view.levels * 0x1p-24);
    }
    CHECK(float{field[node][3]} == 0);
  }
}

TEST_CASE("details above the field level are interpolated") {
  const TestModel model({.levels = 4, .touchable_above = 0.95});
  const ModelView& view = model.view();
  const PlacedBody placed(view);
  std::vector<Float4> field(view.node_count);
  for (const std::uint32_t node : domain_nodes(view)) {
    field[node] = node < view.level[1].node_begin ? splat3(1.0F) : Float4{};
  }
  inverse_transform(view, placed.body->lifting, 0, field.data());
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
