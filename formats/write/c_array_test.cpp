#include "formats/write/c_array.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "formats/testing/synthetic_model.hpp"
#include "formats/verify.hpp"
#include "small_sphere.h"  // written by write_synthetic_models when this test is built

namespace greenloop {
namespace {

TEST_CASE("c array: compiled into a program it is the file, byte for byte, aligned, and verifies in place") {
  const auto file = encode(synthetic_model({.levels = 2}));
  const auto linked = std::as_bytes(std::span(small_sphere));
  CHECK(small_sphere_size == file.size());
  CHECK(std::equal(linked.begin(), linked.end(), file.begin(), file.end()));
  CHECK(reinterpret_cast<std::uintptr_t>(linked.data()) % layout::alignment == 0);
  ModelView view;
  CHECK(verify(linked, view).ok());
}

TEST_CASE("c array: the same text every time") {
  const auto file = encode(synthetic_model({.levels = 1}));
  CHECK(c_array(file, "ball", "ball.h").source == c_array(file, "ball", "ball.h").source);
}

TEST_CASE("c array: refuses names that are no C identifiers") {
  for (const char* name : {"", "2nd", "left-hand", "a b"}) {
    CAPTURE(name);
    CHECK_THROWS_AS((void)c_array({}, name, "x.h"), std::invalid_argument);
  }
}

}  // namespace
}  // namespace greenloop
