#include "runtime/vec.hpp"

#include <doctest/doctest.h>

namespace greenloop {
namespace {

TEST_CASE("vec: floats are viewed as the vectors that they are, and back") {
  alignas(16) float flat[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const auto four = as_vec4(std::span<float>(flat));
  REQUIRE(four.size() == 3);
  CHECK(four[1].x == 4);
  CHECK(four[2].w == 11);
  const auto three = as_vec3(std::span<const float>(flat));
  REQUIRE(three.size() == 4);
  CHECK(three[3].z == 11);
  CHECK(as_floats(four).data() == flat);
  CHECK(as_floats(four).size() == 12);
  CHECK(as_floats(as_vec3(std::span<float>(flat))).size() == 12);
}

TEST_CASE("vec: what is cut or misaligned is no vector") {
  alignas(16) float flat[12] = {};
  CHECK(as_vec4(std::span<float>(flat, 11)).empty());
  CHECK(as_vec4(std::span<const float>(flat + 1, 8)).empty());
  CHECK(as_vec3(std::span<float>(flat, 10)).empty());
  CHECK(as_vec3(std::span<float>(flat + 1, 9)).size() == 3);
  CHECK(as_vec4(std::span<float>()).empty());
}

}  // namespace
}  // namespace greenloop
