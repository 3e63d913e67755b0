#include "offline/report/colour_map.hpp"

#include <doctest/doctest.h>

namespace greenloop::offline {

TEST_CASE("the map darkens steadily, so that it reads in grey too") {
  for (int i = 1; i <= 100; ++i) {
    const float at = static_cast<float>(i) / 100;
    CHECK(luminance(displacement_colour(at)) < luminance(displacement_colour(at - 0.01F)));
  }
}

TEST_CASE("values beyond the ends take the colours of the ends") {
  CHECK(displacement_colour(-1) == displacement_colour(0));
  CHECK(displacement_colour(7) == displacement_colour(1));
  CHECK(displacement_gradient(3).front() == "#e4e6e6");
  CHECK(displacement_gradient(3).back() == "#38124f");
}

}  // namespace greenloop::offline
