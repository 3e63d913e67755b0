#include "offline/simulate/examples/animal.hpp"

#include <doctest/doctest.h>

#include "offline/surface/surface_preparation.hpp"

namespace greenloop::offline::examples {
namespace {

TEST_CASE("the animal is the closed skin of one solid, at every number of levels that a test has time for") {
  for (int levels = 0; levels <= 3; ++levels) {
    const auto prepared = prepare_surface(animal(levels));
    CHECK(prepared.repairs.empty());
    CHECK(prepared.mesh.triangles.size() == animal(0).triangles.size() << (2 * levels));
  }
  CHECK_THROWS_AS(static_cast<void>(animal(7)), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline::examples
