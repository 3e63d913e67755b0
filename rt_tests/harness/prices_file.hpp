#pragma once

#include <string>

#include "runtime/prices.hpp"

namespace greenloop {

/// Prices from a JSON file: an object with a number, in work units, for each that it names; the others are the
/// default ones. Throws std::runtime_error naming the file and what is wrong with it.
[[nodiscard]] Prices read_prices(const std::string& path);

}  // namespace greenloop
