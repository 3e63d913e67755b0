#pragma once

#include <string>

#include "runtime/prices.hpp"

namespace greenloop {

/// Prices from a JSON file: an object with a number, in work units, for each that it names, and perhaps "unit", what
/// such a unit is, in words; the other prices are the default ones. Throws std::runtime_error naming the file and what
/// is wrong with it.
[[nodiscard]] Prices read_prices(const std::string& path);

/// The file that read_prices reads, with every price. unit: what a work unit is then.
[[nodiscard]] std::string prices_as_json(const Prices& prices, const std::string& unit);

/// A C++ header of the same: `greenloop::target_prices`, for Limits::prices.
[[nodiscard]] std::string prices_as_header(const Prices& prices, const std::string& unit);

}  // namespace greenloop
