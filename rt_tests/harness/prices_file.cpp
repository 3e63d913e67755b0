#include "rt_tests/harness/prices_file.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace greenloop {
namespace {

// the member of a name; null: there is none
std::uint32_t* member(Prices& prices, const std::string& name) {
#define GREENLOOP_ROW(member, price, what) \
  if (name == #member) return &prices.member;
  GREENLOOP_PRICES(GREENLOOP_ROW)
#undef GREENLOOP_ROW
  return nullptr;
}

std::uint32_t in_units(const nlohmann::json& value, const std::string& where) {
  const double price = value.is_number() ? std::round(256 * value.get<double>()) : -1;
  if (!(price >= 0 && price <= std::numeric_limits<std::uint32_t>::max())) {
    throw std::runtime_error(where + ": " + value.dump() + " is no price: give work units from 0 to 16777215");
  }
  return static_cast<std::uint32_t>(price);
}

}  // namespace

Prices read_prices(const std::string& path) {
  std::ifstream file(path);
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object()) throw std::runtime_error(path + ": is no JSON object of prices by name");
  Prices prices;
  for (const auto& [name, value] : json.items()) {
    std::uint32_t* const price = member(prices, name);
    if (price == nullptr) throw std::runtime_error(path + ": " + name + " is no price; docs/budgets.md names them");
    *price = in_units(value, path + ": " + name);
  }
  return prices;
}

}  // namespace greenloop
