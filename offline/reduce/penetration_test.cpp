#include "offline/reduce/penetration.hpp"

#include <doctest/doctest.h>

#include <array>

namespace greenloop::offline {
namespace {

TEST_CASE("penetrations: triangles that cross, vertices inside rigid shapes, each in its own frames") {
  const std::vector<std::uint32_t> triangles{0, 1, 2, 3, 4, 5};
  PenetrationCounter counter(triangles, {RigidBox{{0, -2, 0}, {1, -1, 1}}});
  // side by side; the second through the first; two corners of the second in the box
  counter.add(std::array<float, 18>{0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1, 1});
  counter.add(std::array<float, 18>{0, 0, 0, 1, 0, 0, 0, 0, 1, 0.2F, -0.5F, 0.2F, 0.2F, 0.5F, 0.2F, 0.3F, 0.5F, 0.2F});
  counter.add(
      std::array<float, 18>{0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5F, -1.25F, 0.5F, 0.5F, -0.5F, 0.5F, 0.5F, -1.125F, 0.4F});
  const PenetrationCount& count = counter.count();
  CHECK(count.frames == 3);
  CHECK(count.crossing_frames == 1);
  CHECK(count.crossings == 1);
  CHECK(count.inside_frames == 1);
  CHECK(count.deepest == doctest::Approx(0.25));
}

}  // namespace
}  // namespace greenloop::offline
