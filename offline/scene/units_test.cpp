#include "offline/scene/units.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <string_view>

#include "offline/scene/spelling.hpp"

using namespace greenloop::offline;

namespace {

void check_refused(std::string_view text, Dimension dimension, std::string_view message) {
  try {
    static_cast<void>(parse_quantity(text, dimension));
    FAIL("accepted: " << text);
  } catch (const UnitError& error) {
    CAPTURE(std::string(error.what()));
    CHECK(std::string_view(error.what()).find(message) != std::string_view::npos);
  }
}

}  // namespace

TEST_CASE("every unit of length") {
  CHECK(parse_quantity("3 m", Dimension::length) == 3);
  CHECK(parse_quantity("30 cm", Dimension::length) == 0.3);
  CHECK(parse_quantity("7 mm", Dimension::length) == 0.007);
  CHECK(parse_quantity("7 um", Dimension::length) == 7e-6);
  CHECK(parse_quantity("7 \u00b5m", Dimension::length) == 7e-6);
  CHECK(parse_quantity("7 \u03bcm", Dimension::length) == 7e-6);
  CHECK(parse_quantity("2 km", Dimension::length) == 2000);
  CHECK(parse_quantity("1 in", Dimension::length) == 0.0254);
}

TEST_CASE("every unit of pressure") {
  CHECK(parse_quantity("5 Pa", Dimension::pressure) == 5);
  CHECK(parse_quantity("20 kPa", Dimension::pressure) == 20000);
  CHECK(parse_quantity("0.7 MPa", Dimension::pressure) == 700000);
  CHECK(parse_quantity("210 GPa", Dimension::pressure) == 210e9);
  CHECK(parse_quantity("3 N/mm^2", Dimension::pressure) == 3e6);
}

TEST_CASE("every unit of frequency") {
  CHECK(parse_quantity("50 Hz", Dimension::frequency) == 50);
  CHECK(parse_quantity("1 kHz", Dimension::frequency) == 1000);
  CHECK(parse_quantity("1 MHz", Dimension::frequency) == 1e6);
}

TEST_CASE("spaces do not matter, exponents and signs are read") {
  CHECK(parse_quantity("20kPa", Dimension::pressure) == 20000);
  CHECK(parse_quantity("  2e4   Pa ", Dimension::pressure) == 20000);
  CHECK(parse_quantity("-1.5 m", Dimension::length) == -1.5);
}

TEST_CASE("a unit alone") {
  CHECK(parse_unit("cm", Dimension::length) == 0.01);
  CHECK_THROWS_AS(static_cast<void>(parse_unit("kPa", Dimension::length)), UnitError);
}

TEST_CASE("refused: no number") { check_refused("cm", Dimension::length, "\"cm\" does not begin with a number"); }

TEST_CASE("refused: nothing") {
  check_refused("", Dimension::length, "does not begin with a number; write for example \"30 cm\"");
}

TEST_CASE("refused: no unit") {
  check_refused("3.5", Dimension::frequency, "has no unit; write for example \"1 kHz\"");
}

TEST_CASE("refused: another dimension") { check_refused("3 m", Dimension::pressure, "\"m\" is a unit of length"); }

TEST_CASE("refused: an unknown unit, with the nearest one") {
  check_refused("3 mpa", Dimension::pressure, "unknown unit \"mpa\" (did you mean \"MPa\"?)");
  check_refused("3 khz", Dimension::frequency, "did you mean \"kHz\"?");
  check_refused("3 furlongs", Dimension::length, "unknown unit \"furlongs\"; length units are m, cm, mm");
}

TEST_CASE("refused: numbers that are not finite") {
  check_refused("1e999 Pa", Dimension::pressure, "is not a finite number");
  check_refused("inf Pa", Dimension::pressure, "is not a finite number");
  check_refused("nan Pa", Dimension::pressure, "is not a finite number");
  check_refused("1e308 GPa", Dimension::pressure, "is too large");
}

TEST_CASE("the nearest spelling") {
  constexpr std::array<std::string_view, 4> valid{"young", "poisson", "levels", "level"};
  CHECK(nearest_spelling("yuong", valid) == "young");
  CHECK(nearest_spelling("Poisson", valid) == "poisson");
  CHECK(nearest_spelling("poison", valid) == "poisson");
  CHECK(nearest_spelling("levls", valid) == "levels");
  CHECK(nearest_spelling("level", valid) == "level");
  CHECK(nearest_spelling("density", valid).empty());
  CHECK(nearest_spelling("", valid).empty());
}
