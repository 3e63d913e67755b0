#include "sim_hw/control_loop/probe_contacts.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

namespace greenloop {
namespace {

constexpr double radius = 0.05;

/// A square table in z = 0, 21 x 21 nodes 0.01 m apart, facing up.
BodySurface table() {
  BodySurface surface;
  for (int y = -10; y <= 10; ++y) {
    for (int x = -10; x <= 10; ++x) surface.position.push_back({0.01 * x, 0.01 * y, 0});
  }
  surface.normal.assign(surface.position.size(), {0, 0, 1});
  surface.touchable.assign(surface.position.size(), true);
  return surface;
}

/// Pushes down onto (x, 0, 0), `depth` m beyond the first touch.
Probe pressed(double depth, double x = 0) { return {{x, 0, radius - depth}, {0, 0, -1}}; }

struct Bench {
  explicit Bench(std::uint32_t max_contacts = 256) : contacts(surface, radius, max_contacts) {}

  std::span<const Constraint> find(const std::vector<Probe>& probes) { return contacts.find(probes, field); }
  void settle(const std::vector<Probe>& probes, const std::vector<float>& force) { contacts.settle(probes, force); }

  BodySurface surface = table();
  std::vector<float> field = std::vector<float>(4 * surface.position.size());
  ProbeContacts contacts;
};

TEST_CASE("a probe above the surface touches nothing") {
  Bench bench;
  CHECK(bench.find({pressed(-1e-6)}).empty());
  CHECK(bench.find({}).empty());
}

TEST_CASE("the nodes inside the sphere are held where it leaves them, along its axis, by increasing node") {
  Bench bench;
  const Probe probe = pressed(0.01);
  const auto found = bench.find({probe});
  std::set<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < bench.surface.position.size(); ++i) {
    if (norm(bench.surface.position[i] - probe.centre) < radius * (1 - 1e-3)) expected.insert(i);
  }
  REQUIRE(found.size() == expected.size());
  CHECK(found.size() == 25);  // nearer than 3 cm
  auto next = expected.begin();
  for (const Constraint& contact : found) {
    CHECK(contact.node == *next++);
    CHECK(contact.value[0] == 0);
    CHECK(contact.value[1] == 0);
    CHECK(contact.value[2] < 0);
    const Double3 held = bench.surface.position[contact.node] + Double3{0, 0, contact.value[2]};
    CHECK(norm(held - probe.centre) == doctest::Approx(radius).epsilon(1e-6));
  }
}

TEST_CASE("nodes that face away or cannot be touched are left alone") {
  Bench bench;
  CHECK(bench.find({Probe{{0, 0, -radius + 0.01}, {0, 0, 1}}}).empty());
  BodySurface closed = table();
  closed.touchable.assign(closed.touchable.size(), false);
  closed.touchable[220] = true;  // the middle
  ProbeContacts contacts(closed, radius, 256);
  const std::vector<Probe> probes{pressed(0.01)};
  const auto found = contacts.find(probes, bench.field);
  REQUIRE(found.size() == 1);
  CHECK(found[0].node == 220);
}

TEST_CASE("of too many contacts the deepest are kept, of equal ones the first") {
  Bench bench(6);
  const auto found = bench.find({pressed(0.01)});
  REQUIRE(found.size() == 6);
  // the middle, its four neighbours, and the first of the four on the diagonal
  const std::array<std::uint32_t, 6> expected{198, 199, 219, 220, 221, 241};
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(found[i].node == expected[i]);
}

TEST_CASE("a node inside two probes is held once, by the one that pushes it deeper") {
  Bench bench;
  const std::vector<Probe> probes{pressed(0.01, -0.02), pressed(0.02, 0.02)};
  const auto found = bench.find(probes);
  std::set<std::uint32_t> nodes;
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(nodes.insert(found[i].node).second);
    const Double3& place = bench.surface.position[found[i].node];
    if (std::abs(place.x) < 1e-12) CHECK(bench.contacts.holder()[i] == 1);
    if (place.x < -0.035) CHECK(bench.contacts.holder()[i] == 0);
  }
}

TEST_CASE("a contact that had to be pulled is released in the next cycle, a pushed one stays") {
  Bench bench;
  const std::vector<Probe> probes{pressed(0.01)};
  const auto found = bench.find(probes);
  const std::uint32_t pulled = found[0].node;
  const std::size_t count = found.size();
  std::vector<float> force(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    force[3 * i + 2] = i == 0 ? 1.0F : -1.0F;  // up pulls, down pushes
    for (std::size_t c = 0; c < 3; ++c) bench.field[std::size_t{4} * found[i].node + c] = found[i].value[c];
  }
  bench.settle(probes, force);
  const auto next = bench.find(probes);
  CHECK(next.size() == count - 1);
  for (const Constraint& contact : next) CHECK(contact.node != pulled);
}

TEST_CASE("a released node comes back when its deformed place lies inside the probe") {
  Bench bench;
  const std::vector<Probe> probes{pressed(0.01)};
  const std::uint32_t middle = 220;
  bench.field[4 * middle + 2] = -0.0101F;
  for (const Constraint& contact : bench.find(probes)) CHECK(contact.node != middle);
  bench.field[4 * middle + 2] = -0.009F;
  bool back = false;
  for (const Constraint& contact : bench.find(probes)) back = back || contact.node == middle;
  CHECK(back);
}

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
  const NodeGrid grid(position, nodes, 0.07);
  for (int trial = 0; trial < 500; ++trial) {
    const Double3 centre{uniform(-0.3, 1.3), uniform(-0.3, 0.6), uniform(-0.1, 0.1)};
    std::multiset<std::uint32_t> found;
    grid.near(centre, 0.1, [&](std::uint32_t node) {
      if (norm(position[node] - centre) < 0.1) found.insert(node);
    });
    std::multiset<std::uint32_t> expected;
    for (const std::uint32_t node : nodes) {
      if (norm(position[node] - centre) < 0.1) expected.insert(node);
    }
    REQUIRE(found == expected);
  }
}

}  // namespace
}  // namespace greenloop
