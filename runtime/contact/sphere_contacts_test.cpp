#include "runtime/contact/sphere_contacts.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

constexpr double radius = 0.05;

/// A square table in z = 0, 21 x 21 nodes 0.01 m apart, facing up.
struct Table {
  Table() {
    for (int y = -10; y <= 10; ++y) {
      for (int x = -10; x <= 10; ++x) {
        touchable.push_back(static_cast<std::uint32_t>(position.size()));
        position.push_back({0.01 * x, 0.01 * y, 0});
      }
    }
    normal.assign(position.size(), {0, 0, 1});
  }
  [[nodiscard]] SurfaceNodes nodes() const { return {position, normal, touchable}; }

  std::vector<Double3> position, normal;
  std::vector<std::uint32_t> touchable;
};

/// Pushes down onto (x, 0, 0), `depth` m beyond the first touch.
SphereTool pressed(double depth, double x = 0) { return {{x, 0, radius - depth}, {0, 0, -1}}; }

struct Bench {
  explicit Bench(std::uint32_t max_contacts = 256, const Table& of = {})
      : table(of), memory(SphereContacts::required(table.nodes(), {radius, max_contacts})) {
    auto created = SphereContacts::create(table.nodes(), {radius, max_contacts}, {memory.data(), memory.size()});
    REQUIRE(created);
    contacts = created.contacts;
  }

  std::span<const Constraint> find(const std::vector<SphereTool>& tools) { return contacts.find(tools, field); }
  void settle(const std::vector<SphereTool>& tools, const std::vector<float>& force) { contacts.settle(tools, force); }

  Table table;
  AlignedBytes memory;
  std::vector<float> field = std::vector<float>(4 * table.position.size());
  SphereContacts contacts;
};

TEST_CASE("a sphere above the surface touches nothing") {
  Bench bench;
  CHECK(bench.find({pressed(-1e-6)}).empty());
  CHECK(bench.find({}).empty());
}

TEST_CASE("the nodes inside the sphere are held where it leaves them, along its axis, by increasing node") {
  Bench bench;
  const SphereTool tool = pressed(0.01);
  const auto found = bench.find({tool});
  std::set<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < bench.table.position.size(); ++i) {
    if (norm(bench.table.position[i] - tool.centre) < radius * (1 - 1e-3)) expected.insert(i);
  }
  REQUIRE(found.size() == expected.size());
  CHECK(found.size() == 25);  // nearer than 3 cm
  auto next = expected.begin();
  for (const Constraint& contact : found) {
    CHECK(contact.node == *next++);
    CHECK(contact.value[0] == 0);
    CHECK(contact.value[1] == 0);
    CHECK(contact.value[2] < 0);
    const Double3 held = bench.table.position[contact.node] + Double3{0, 0, contact.value[2]};
    CHECK(norm(held - tool.centre) == doctest::Approx(radius).epsilon(1e-6));
  }
}

TEST_CASE("nodes that face away or cannot be touched are left alone") {
  Bench bench;
  CHECK(bench.find({SphereTool{{0, 0, -radius + 0.01}, {0, 0, 1}}}).empty());
  Table closed;
  closed.touchable = {220};  // the middle
  Bench middle(256, closed);
  const auto found = middle.find({pressed(0.01)});
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

TEST_CASE("a node inside two spheres is held once, by the one that pushes it deeper") {
  Bench bench;
  const std::vector<SphereTool> tools{pressed(0.01, -0.02), pressed(0.02, 0.02)};
  const auto found = bench.find(tools);
  std::set<std::uint32_t> nodes;
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(nodes.insert(found[i].node).second);
    const Double3& place = bench.table.position[found[i].node];
    if (std::abs(place.x) < 1e-12) CHECK(bench.contacts.holder(i) == 1);
    if (place.x < -0.035) CHECK(bench.contacts.holder(i) == 0);
  }
}

TEST_CASE("a contact that had to be pulled is released in the next cycle, a pushed one stays") {
  Bench bench;
  const std::vector<SphereTool> tools{pressed(0.01)};
  const auto found = bench.find(tools);
  const std::uint32_t pulled = found[0].node;
  const std::size_t count = found.size();
  std::vector<float> force(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    force[3 * i + 2] = i == 0 ? 1.0F : -1.0F;  // up pulls, down pushes
    for (std::size_t c = 0; c < 3; ++c) bench.field[std::size_t{4} * found[i].node + c] = found[i].value[c];
  }
  bench.settle(tools, force);
  const auto next = bench.find(tools);
  CHECK(next.size() == count - 1);
  for (const Constraint& contact : next) CHECK(contact.node != pulled);
}

TEST_CASE("a released node comes back when its deformed place lies inside the sphere") {
  Bench bench;
  const std::vector<SphereTool> tools{pressed(0.01)};
  const std::uint32_t middle = 220;
  bench.field[4 * middle + 2] = -0.0101F;
  for (const Constraint& contact : bench.find(tools)) CHECK(contact.node != middle);
  bench.field[4 * middle + 2] = -0.009F;
  bool back = false;
  for (const Constraint& contact : bench.find(tools)) back = back || contact.node == middle;
  CHECK(back);
}

TEST_CASE("what one cycle found is forgotten in the next, also where there were too many") {
  Bench bench(6), fresh(6);
  CHECK(bench.find({pressed(0.03, 0.05)}).size() == 6);
  CHECK(bench.find({pressed(-1e-6)}).empty());
  const auto found = bench.find({pressed(0.01)}), expected = fresh.find({pressed(0.01)});
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].node == expected[i].node);
    CHECK(found[i].value[2] == expected[i].value[2]);
  }
}

TEST_CASE("a tool that is not finite holds nothing, and the others what they hold without it") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    CAPTURE(bad);
    Bench bench;
    CHECK(bench.find({SphereTool{{bad, 0, 0.04}, {0, 0, -1}}}).empty());
    CHECK(bench.find({SphereTool{{0, 0, bad}, {0, 0, -1}}}).empty());
    const std::size_t count = bench.find({SphereTool{{0, 0, 0.04}, {bad, 0, -1}}, pressed(0.01)}).size();
    CHECK(count == 25);
    for (std::size_t i = 0; i < count; ++i) CHECK(bench.contacts.holder(i) == 1);
  }
}

TEST_CASE("no memory, too little and misaligned memory, and limits without sense are refused") {
  const Table table;
  const SphereContacts::Limits limits{radius, 8};
  const std::size_t bytes = SphereContacts::required(table.nodes(), limits);
  REQUIRE(bytes > 0);
  AlignedBytes memory(bytes + 64);
  const auto error = [&](const SurfaceNodes& nodes, const SphereContacts::Limits& l, std::size_t from,
                         std::size_t size) {
    return SphereContacts::create(nodes, l, {memory.data() + from, size}).error;
  };
  CHECK(error(table.nodes(), limits, 0, bytes) == CreateError::none);
  CHECK(error(table.nodes(), limits, 0, bytes - 1) == CreateError::arena_too_small);
  CHECK(error(table.nodes(), limits, 0, 0) == CreateError::arena_too_small);
  CHECK(error(table.nodes(), limits, 8, bytes) == CreateError::arena_misaligned);
  const auto small = SphereContacts::create(table.nodes(), limits, {memory.data(), bytes - 1});
  CHECK(small.requested == bytes);
  CHECK(small.available == bytes - 1);
  CHECK(small.missing == 1);
  for (const SphereContacts::Limits& bad :
       {SphereContacts::Limits{0, 8}, {-1, 8}, {std::numeric_limits<double>::quiet_NaN(), 8}, {radius, 0}}) {
    CHECK(SphereContacts::required(table.nodes(), bad) == 0);
    CHECK(error(table.nodes(), bad, 0, bytes) == CreateError::bad_limits);
  }
  CHECK(error({table.position, table.normal, {}}, limits, 0, bytes) == CreateError::bad_limits);
  CHECK(error({table.position, {}, table.touchable}, limits, 0, bytes) == CreateError::bad_limits);
}

}  // namespace
}  // namespace greenloop
