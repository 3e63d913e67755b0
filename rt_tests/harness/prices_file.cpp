#include "rt_tests/harness/prices_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "formats/output/json_text.hpp"
#include "formats/write/nested_json.hpp"
#include "rt_tests/harness/price_table.hpp"

namespace greenloop {
namespace {

// the price of a name; null: there is none
std::uint32_t* price_of(Prices& prices, const std::string& name) {
  const auto row = std::find_if(std::begin(price_rows), std::end(price_rows),
                                [&](const PriceRow& candidate) { return name == candidate.name; });
  return row == std::end(price_rows) ? nullptr : &(prices.*row->member);
}

constexpr std::size_t most_bytes = std::size_t{1} << 16;

std::uint32_t in_units(const nlohmann::json& value, const std::string& where) {
  const double price = value.is_number() ? std::round(256 * value.get<double>()) : -1;
  if (!(price >= 0 && price <= std::numeric_limits<std::uint32_t>::max())) {
    throw std::runtime_error(where + ": " + greenloop::json_text(value, -1) +
                             " is no price: give work units from 0 to 16777215");
  }
  return static_cast<std::uint32_t>(price);
}

}  // namespace

Prices read_prices(const std::string& path) {
  std::ifstream file(path);
  std::string text(most_bytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() == most_bytes) throw std::runtime_error(path + ": is longer than any file of prices, 64 kB");
  require_shallow(text, path);
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) throw std::runtime_error(path + ": is no JSON object of prices by name");
  Prices prices;
  for (const auto& [name, value] : json.items()) {
    if (name == "unit" && value.is_string()) continue;
    const std::string where = std::string(path).append(": ").append(name);
    std::uint32_t* const price = price_of(prices, name);
    if (price == nullptr) throw std::runtime_error(where + " is no price; docs/budgets.md names them");
    *price = in_units(value, where);
  }
  return prices;
}

std::string prices_as_json(const Prices& prices, const std::string& unit) {
  nlohmann::ordered_json json = {{"unit", unit}};
  for (const PriceRow& row : price_rows) json[row.name] = prices.*row.member / 256.0;
  return json_text(json) + "\n";
}

std::string prices_as_header(const Prices& prices, const std::string& unit) {
  std::ostringstream header;
  header << "#pragma once\n\n#include <runtime/prices.hpp>\n\nnamespace greenloop {\n\n"
         << "/// Prices of a target, for Limits::prices. A work unit is: " << unit << ".\n"
         << "constexpr Prices target_prices() {\n  Prices prices;\n";
  for (const PriceRow& row : price_rows) {
    header << "  prices." << row.name << " = " << prices.*row.member << ";  // " << row.what << '\n';
  }
  header << "  return prices;\n}\n\n}  // namespace greenloop\n";
  return header.str();
}

}  // namespace greenloop
