#include "offline/compress/encode/representatives.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>

#include "formats/layout.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/encode/model_tables.hpp"
#include "offline/compress/testing/test_body.hpp"

namespace greenloop::offline {
namespace {

constexpr std::uint32_t free_and_touchable = layout::node_domain | layout::node_touchable;

struct Surface {
  SemiRegularMesh mesh = test::blob(3);
  std::vector<std::uint32_t> flags = std::vector<std::uint32_t>(mesh.positions.size(), free_and_touchable);
};

TEST_CASE("on the finest level every touchable node stands for itself") {
  Surface s;
  s.flags[7] = layout::node_domain | layout::node_read;
  s.flags[8] = layout::node_fixed | layout::node_touchable;
  const auto found = representatives(s.mesh, s.flags, 3);
  REQUIRE(found.size() == s.flags.size());
  for (std::size_t node = 0; node < found.size(); ++node) {
    CHECK(found[node] == (node == 7 || node == 8 ? layout::none : node));
  }
}

TEST_CASE("a midpoint is represented by its first parent, a node of the level by itself") {
  const Surface s;
  for (std::size_t level = 0; level < 3; ++level) {
    CAPTURE(level);
    const auto found = representatives(s.mesh, s.flags, level);
    for (std::size_t node = 0; node < s.mesh.vertex_end[level + 1]; ++node) {
      CHECK(found[node] ==
            (node < s.mesh.vertex_end[level] ? node : static_cast<std::size_t>(s.mesh.parents[node][0])));
    }
  }
}

TEST_CASE("two levels up the nearer end of the edge counts, whatever its number") {
  const Surface s;
  const auto found = representatives(s.mesh, s.flags, 1);
  std::size_t quarters = 0;
  for (std::size_t node = s.mesh.vertex_end[2]; node < s.mesh.vertex_end[3]; ++node) {
    const auto a = static_cast<std::size_t>(s.mesh.parents[node][0]);
    if (a < s.mesh.vertex_end[1]) {
      CHECK(found[node] == a);  // three quarters of a hat, or a half besides two quarters
      ++quarters;
    }
  }
  CHECK(quarters > 100);
}

TEST_CASE("a parent outside the domain does not represent") {
  Surface s;
  const std::size_t node = s.mesh.vertex_end[0];
  const auto [a, b] = s.mesh.parents[node];
  s.flags[static_cast<std::size_t>(a)] = layout::node_fixed;
  CHECK(representatives(s.mesh, s.flags, 0)[node] == static_cast<std::uint32_t>(b));
}

TEST_CASE("where no hat reaches, the nearest domain node of the level represents") {
  Surface s;
  const std::size_t a = 2, b = 7;
  for (std::size_t node = 0; node < s.mesh.vertex_end[0]; ++node) {
    if (node != a && node != b) s.flags[node] = layout::node_fixed;
  }
  const auto found = representatives(s.mesh, s.flags, 0);
  std::size_t unreached = 0;
  for (std::size_t node = s.mesh.vertex_end[0]; node < s.mesh.vertex_end[1]; ++node) {
    const auto& parents = s.mesh.parents[node];
    if (std::any_of(parents.begin(), parents.end(), [](int p) { return p == 2 || p == 7; })) continue;
    const auto distance = [&](std::size_t k) { return (s.mesh.positions[k] - s.mesh.positions[node]).norm(); };
    CHECK(found[node] == (distance(a) < distance(b) ? a : b));
    ++unreached;
  }
  CHECK(unreached > 10);
}

TEST_CASE("a level without domain nodes represents nobody, and is left out of a model") {
  Surface s;
  for (std::size_t node = 0; node < s.mesh.vertex_end[0]; ++node) s.flags[node] = layout::node_fixed;
  const auto found = representatives(s.mesh, s.flags, 0);
  CHECK(std::all_of(found.begin(), found.end(), [](std::uint32_t r) { return r == layout::none; }));

  ModelData model;
  model.levels.resize(4);
  add_representatives(s.mesh, s.flags, model);
  CHECK(model.info.coarsest_constraint_level == 1);
  CHECK(model.levels[0].representatives.empty());
  for (std::size_t level = 1; level < 4; ++level) {
    const auto expected = representatives(s.mesh, s.flags, level);
    std::vector<std::uint32_t> joined;
    REQUIRE(model.levels[level].representatives.size() == 4);
    for (std::size_t q = 0; q < 4; ++q) {
      const auto& part = model.levels[level].representatives[q];
      joined.insert(joined.end(), part.begin(), part.end());
      CHECK(joined.size() == s.mesh.vertex_end[q]);
    }
    CHECK(joined == expected);
  }
}

TEST_CASE("a body that cannot be touched is refused") {
  Surface s;
  std::fill(s.flags.begin(), s.flags.end(), layout::node_domain | layout::node_read);
  ModelData model;
  model.levels.resize(4);
  CHECK_THROWS_AS(add_representatives(s.mesh, s.flags, model), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
