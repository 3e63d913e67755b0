#include "runtime/contact/node_grid.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

/// A grid in memory of its own.
struct HeldGrid {
  HeldGrid(const std::vector<Double3>& position, const std::vector<std::uint32_t>& nodes, double cell) {
    Arena counting;
    grid.carve(counting, position, nodes, cell);
    memory = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory.data());
    grid.carve(arena, position, nodes, cell);
    grid.fill(position, nodes);
  }
  AlignedBytes memory;
  NodeGrid grid;
};

TEST_CASE("the grid finds what a search through all nodes finds") {
  constexpr std::uint64_t seed = 2003;
  INFO("seed ", seed);
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  std::vector<Double3> position(500);
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < position.size(); ++i) {
    position[i] = {uniform(0, 1), uniform(0, 0.3), uniform(0, 0.01)};
    if (i % 3 != 0) nodes.push_back(i);
  }
  const HeldGrid held(position, nodes, 0.07);
  CHECK(held.grid.cells().x > held.grid.cells().y);
  CHECK(held.grid.cells().z == 1);
  for (int trial = 0; trial < 500; ++trial) {
    const Double3 centre{uniform(-0.3, 1.3), uniform(-0.3, 0.6), uniform(-0.1, 0.1)};
    std::multiset<std::uint32_t> found;
    held.grid.near(centre, 0.1, [&](std::uint32_t node) {
      if (norm(position[node] - centre) < 0.1) found.insert(node);
    });
    std::multiset<std::uint32_t> expected;
    for (const std::uint32_t node : nodes) {
      if (norm(position[node] - centre) < 0.1) expected.insert(node);
    }
    REQUIRE(found == expected);
  }
}

TEST_CASE("a grid has as many cells as fit, at least one and at most 64 in a row") {
  const std::vector<Double3> position{{0, 0, 0}, {1, 0.25, 0}};
  const std::vector<std::uint32_t> nodes{0, 1};
  const HeldGrid coarse(position, nodes, 10), fine(position, nodes, 1e-9), whole(position, nodes, 0.125);
  CHECK(coarse.grid.cells().x == 1);
  CHECK(fine.grid.cells().x == 64);
  CHECK(fine.grid.cells().y == 16);
  CHECK(fine.grid.cells().z == 1);
  CHECK(whole.grid.cells().x == 8);
  CHECK(whole.grid.cells().y == 2);
}

TEST_CASE("a place that is no number, or beyond all nodes, is looked for in the cells at the border") {
  const std::vector<Double3> position{{0, 0, 0}, {1, 1, 1}};
  const std::vector<std::uint32_t> nodes{0, 1};
  const HeldGrid held(position, nodes, 0.1);
  const auto near = [&](const Double3& centre) {
    std::vector<std::uint32_t> found;
    held.grid.near(centre, 0.05, [&](std::uint32_t node) { found.push_back(node); });
    return found;
  };
  constexpr double far = 1e300, nothing = std::numeric_limits<double>::quiet_NaN();
  CHECK(near({far, far, far}) == std::vector<std::uint32_t>{1});
  CHECK(near({-far, -far, -far}) == std::vector<std::uint32_t>{0});
  CHECK(near({nothing, nothing, nothing}) == std::vector<std::uint32_t>{0});
  CHECK(near({0.5, 0.5, 0.5}).empty());
}

}  // namespace
}  // namespace greenloop
