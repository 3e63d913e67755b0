#include "rt_tests/calibrate/calibration_report.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "rt_tests/harness/price_table.hpp"

namespace greenloop {
nlohmann::json as_json(const Calibration& calibration) {
  nlohmann::json prices = nlohmann::json::array(), ways = nlohmann::json::object();
  for (std::size_t j = 0; j < price_count; ++j) {
    const PriceRow& row = price_rows[j];
    prices.push_back({{"name", row.name},
                      {"price", calibration.prices.*row.member / 256.0},
                      {"unit", calibration.unit},
                      {"what", row.what},
                      {"steps", calibration.paying[j]}});
  }
  for (const auto& [way, ratios] : calibration.ways) ways[way] = as_json(ratios);
  return {{"prices", prices},
          {"fitted_steps", calibration.fitted},
          {"predicted_over_measured", {{"all", as_json(calibration.all)}, {"ways", ways}}}};
}

void print(const Calibration& calibration) {
  fmt::print("Prices, fitted to {} steps:\n\n{:<24} {:>10} {:>8}  {}\n", calibration.fitted, "", calibration.unit,
             "steps", "what it is the price of");
  for (std::size_t j = 0; j < price_count; ++j) {
    const PriceRow& row = price_rows[j];
    const std::uint64_t steps = calibration.paying[j];
    fmt::print("{:<24} {:>10.3f} {:>8}  {}\n", row.name, calibration.prices.*row.member / 256.0,
               steps > 0 ? std::to_string(steps) : "usual", row.what);
  }
  fmt::print("\nPredicted over measured, of {} other steps:\n", calibration.all.steps);
  print_ratios(calibration.ways, calibration.all);
}

}  // namespace greenloop
