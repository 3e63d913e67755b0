#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace greenloop::offline {

enum class Dimension { length, pressure, frequency, density, time, speed, rate, sheet_density, tension, torque };

/// A quantity that cannot be read; the message says what is wrong with it and names the nearest valid unit.
class UnitError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Value in SI (m, Pa, Hz, kg/m^3) of a number with a unit, such as "20 kPa", "30cm" or "1e3 Hz".
/// Length: m, cm, mm, um, µm, km, in; pressure: Pa, kPa, MPa, GPa, N/mm^2; frequency: Hz, kHz, MHz;
/// density: kg/m^3, kg/m3, g/cm^3, g/cm3, kg/L, kg/l; time: s, ms, us; speed: m/s, cm/s, mm/s; rate: 1/s, 1/ms;
/// of sheets: kg/m^2, g/m^2; N/m, kN/m; N m, mN m.
/// The result is the double nearest to the product wherever the number and its SI value are exact.
/// Throws UnitError if number or unit is missing, the unit is unknown or of another dimension, or the number not
/// finite.
[[nodiscard]] double parse_quantity(std::string_view text, Dimension dimension);

/// Value in SI of one such unit, "cm" -> 0.01. Throws UnitError.
[[nodiscard]] double parse_unit(std::string_view text, Dimension dimension);

/// An example to show, such as "20 kPa".
[[nodiscard]] std::string_view example_of(Dimension dimension);

}  // namespace greenloop::offline
