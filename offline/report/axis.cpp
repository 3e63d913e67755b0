#include "offline/report/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace greenloop::offline {
namespace {

constexpr const char* thin_space = "\u202f";

double nice_step(double range, int most) {
  const double rough = range / most;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double multiple : {1.0, 2.0, 5.0}) {
    if (multiple * power >= rough * (1 - 1e-9)) return multiple * power;
  }
  return 10 * power;
}

std::string group_thousands(const std::string& digits) {
  const std::size_t end = std::min(digits.find('.'), digits.size());
  const std::size_t begin = digits.starts_with('-') ? 1 : 0;
  if (end - begin <= 4) return digits;
  std::string grouped;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > begin && i < end && (end - i) % 3 == 0) grouped += thin_space;
    grouped += digits[i];
  }
  return grouped;
}

void trim_zeros(std::string& text) {
  if (text.find('.') == std::string::npos) return;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
}

}  // namespace

std::vector<double> linear_ticks(double min, double max, int most) {
  if (!(min < max) || !std::isfinite(max - min)) return {};
  const double step = nice_step(max - min, std::max(most, 1));
  const double first = std::ceil(min / step - 1e-9), last = std::floor(max / step + 1e-9);
  // beyond, the ends are too near to each other, or to zero, for numbers between them
  constexpr double largest_multiple = 1e12;
  if (!(std::abs(first) < largest_multiple && std::abs(last) < largest_multiple)) return {};
  std::vector<double> ticks;
  for (int k = 0; k <= std::max(most, 1) && first + k <= last; ++k) ticks.push_back((first + k) * step);
  return ticks;
}

std::vector<double> logarithmic_ticks(double min, double max) {
  if (!(0 < min && min < max) || !std::isfinite(max)) return {};
  const bool dense = std::log10(max / min) < 2;
  std::vector<double> ticks;
  for (double decade = std::floor(std::log10(min)); decade <= std::log10(max); ++decade) {
    for (const double multiple : {1.0, 2.0, 5.0}) {
      const double tick = multiple * std::pow(10.0, decade);
      const bool inside = tick >= min * (1 - 1e-9) && tick <= max * (1 + 1e-9);
      if (inside && (dense || multiple == 1)) ticks.push_back(tick);
    }
  }
  return ticks;
}

SiPrefix si_prefix(double largest) {
  static const std::array<SiPrefix, 7> prefixes{
      {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}}};
  for (const SiPrefix& prefix : prefixes) {
    if (std::abs(largest) >= prefix.factor && std::abs(largest) < 1000 * prefix.factor) return prefix;
  }
  return {};
}

std::string readable(double value, int digits) {
  if (!std::isfinite(value)) return std::isnan(value) ? "not a number" : value > 0 ? "∞" : "−∞";
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-4 || size >= 1e15) return fmt::format("{:.{}g}", value, digits);
  const int magnitude = static_cast<int>(std::floor(std::log10(size)));
  std::string text = fmt::format("{:.{}f}", value, std::max(digits - 1 - magnitude, 0));
  trim_zeros(text);
  return group_thousands(text);
}

std::string readable_count(unsigned long long value) { return group_thousands(fmt::format("{}", value)); }

std::string readable_percent(double ratio) { return readable(100 * ratio, 3) + thin_space + "%"; }

std::string readable_bytes(double bytes) {
  const SiPrefix prefix = si_prefix(bytes);
  return readable(bytes / prefix.factor, 3) + thin_space + prefix.symbol + "B";
}

double Scale::operator()(double value) const {
  const double place = logarithmic ? std::log(value / min) / std::log(max / min) : (value - min) / (max - min);
  return from + place * (to - from);
}

std::vector<double> Scale::ticks(int most) const {
  auto ticks = logarithmic ? logarithmic_ticks(min, max) : linear_ticks(min, max, most);
  if (whole) std::erase_if(ticks, [](double tick) { return std::abs(tick - std::round(tick)) > 1e-6; });
  return ticks;
}

}  // namespace greenloop::offline
