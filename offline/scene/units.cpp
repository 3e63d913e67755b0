#include "offline/scene/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "offline/scene/spelling.hpp"

namespace greenloop::offline {
namespace {

/// A unit is times / per of the SI unit: two whole numbers, so that "30 cm" is exactly the double 0.3.
struct Unit {
  std::string_view name;
  Dimension dimension;
  double times;
  double per;
};

constexpr std::array<Unit, 36> units{{{"m", Dimension::length, 1, 1},
                                      {"cm", Dimension::length, 1, 1e2},
                                      {"mm", Dimension::length, 1, 1e3},
                                      {"um", Dimension::length, 1, 1e6},
                                      {"\u00b5m", Dimension::length, 1, 1e6},  // micro sign
                                      {"\u03bcm", Dimension::length, 1, 1e6},  // Greek mu
                                      {"km", Dimension::length, 1e3, 1},
                                      {"in", Dimension::length, 254, 1e4},
                                      {"Pa", Dimension::pressure, 1, 1},
                                      {"kPa", Dimension::pressure, 1e3, 1},
                                      {"MPa", Dimension::pressure, 1e6, 1},
                                      {"GPa", Dimension::pressure, 1e9, 1},
                                      {"N/mm^2", Dimension::pressure, 1e6, 1},
                                      {"Hz", Dimension::frequency, 1, 1},
                                      {"kHz", Dimension::frequency, 1e3, 1},
                                      {"MHz", Dimension::frequency, 1e6, 1},
                                      {"kg/m^3", Dimension::density, 1, 1},
                                      {"kg/m3", Dimension::density, 1, 1},
                                      {"g/cm^3", Dimension::density, 1e3, 1},
                                      {"g/cm3", Dimension::density, 1e3, 1},
                                      {"kg/L", Dimension::density, 1e3, 1},
                                      {"kg/l", Dimension::density, 1e3, 1},
                                      {"s", Dimension::time, 1, 1},
                                      {"ms", Dimension::time, 1, 1e3},
                                      {"us", Dimension::time, 1, 1e6},
                                      {"m/s", Dimension::speed, 1, 1},
                                      {"cm/s", Dimension::speed, 1, 1e2},
                                      {"mm/s", Dimension::speed, 1, 1e3},
                                      {"1/s", Dimension::rate, 1, 1},
                                      {"1/ms", Dimension::rate, 1e3, 1},
                                      {"kg/m^2", Dimension::sheet_density, 1, 1},
                                      {"g/m^2", Dimension::sheet_density, 1, 1e3},
                                      {"N/m", Dimension::tension, 1, 1},
                                      {"kN/m", Dimension::tension, 1e3, 1},
                                      {"N m", Dimension::torque, 1, 1},
                                      {"mN m", Dimension::torque, 1, 1e3}}};

std::string_view name_of(Dimension dimension) {
  constexpr std::array<std::string_view, 10> names{"length", "pressure", "frequency",         "density", "time",
                                                   "speed",  "rate",     "density of sheets", "tension", "torque"};
  return names[static_cast<std::size_t>(dimension)];
}

std::vector<std::string_view> names_of_units(Dimension dimension) {
  std::vector<std::string_view> names;
  for (const auto& unit : units) {
    if (unit.dimension == dimension) {
      names.push_back(unit.name);
    }
  }
  return names;
}

std::string in_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }

const Unit& find_unit(std::string_view text, Dimension dimension) {
  const auto* const it = std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == text; });
  const auto valid = names_of_units(dimension);
  const auto known = std::string(name_of(dimension)) + " units are " + comma_list(valid);
  if (it == units.end()) {
    throw UnitError("unknown unit " + in_quotes(text) + did_you_mean(text, valid) + "; " + known);
  }
  if (it->dimension != dimension) {
    throw UnitError(in_quotes(text) + " is a unit of " + std::string(name_of(it->dimension)) + "; " + known);
  }
  return *it;
}

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  return begin == std::string_view::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

}  // namespace

std::string_view example_of(Dimension dimension) {
  constexpr std::array<std::string_view, 10> examples{"30 cm",   "20 kPa", "1 kHz",      "1000 kg/m^3", "10 ms",
                                                      "0.5 m/s", "2 1/s",  "0.2 kg/m^2", "500 N/m",     "0.1 mN m"};
  return examples[static_cast<std::size_t>(dimension)];
}

double parse_quantity(std::string_view text, Dimension dimension) {
  const auto body = trimmed(text);
  double number = 0;
  const auto [end, error] = std::from_chars(body.data(), body.data() + body.size(), number);
  if (error == std::errc::invalid_argument) {
    throw UnitError(in_quotes(text) + " does not begin with a number; write for example " +
                    in_quotes(example_of(dimension)));
  }
  if (error != std::errc{} || !std::isfinite(number)) {
    throw UnitError(in_quotes(text) + " is not a finite number");
  }
  const auto unit_text = trimmed(body.substr(static_cast<std::size_t>(end - body.data())));
  if (unit_text.empty()) {
    throw UnitError(in_quotes(text) + " has no unit; write for example " + in_quotes(example_of(dimension)));
  }
  const auto& unit = find_unit(unit_text, dimension);
  const double value = number * unit.times / unit.per;
  if (!std::isfinite(value)) {
    throw UnitError(in_quotes(text) + " is too large");
  }
  return value;
}

double parse_unit(std::string_view text, Dimension dimension) {
  const auto& unit = find_unit(trimmed(text), dimension);
  return unit.times / unit.per;
}

}  // namespace greenloop::offline
