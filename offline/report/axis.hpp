#pragma once

#include <string>
#include <vector>

namespace greenloop::offline {

/// Multiples of 1, 2 or 5 times a power of ten within [min, max], at most `most` + 1 of them (`most` >= 1).
/// Empty unless min < max and both are finite, and where these have no such numbers between them.
[[nodiscard]] std::vector<double> linear_ticks(double min, double max, int most);

/// Decades within [min, max] (0 < min < max); below two whole decades also 2 and 5 times a power of ten.
[[nodiscard]] std::vector<double> logarithmic_ticks(double min, double max);

/// A factor and its SI symbol: value = factor * shown.
struct SiPrefix {
  double factor = 1;
  std::string symbol;
};

/// The prefix (n .. G) with which `largest` reads as a number in [1, 1000); none for zero and outside that range.
[[nodiscard]] SiPrefix si_prefix(double largest);

/// `value` to `digits` significant digits, without exponent between 1e-4 and 1e15, thousands set apart by thin spaces.
[[nodiscard]] std::string readable(double value, int digits = 4);

/// A whole number, thousands set apart by thin spaces.
[[nodiscard]] std::string readable_count(unsigned long long value);

/// A percentage of three significant digits, sign included: 0.0123 reads "1.23 %".
[[nodiscard]] std::string readable_percent(double ratio);

/// Bytes with an SI prefix: "1.25 MB".
[[nodiscard]] std::string readable_bytes(double bytes);

/// Data to pixels along one axis; `from` and `to` are the pixels of min and max.
struct Scale {
  double min = 0;
  double max = 1;
  double from = 0;
  double to = 1;
  bool logarithmic = false;
  bool whole = false;  ///< ticks at whole numbers only

  [[nodiscard]] double operator()(double value) const;
  [[nodiscard]] std::vector<double> ticks(int most) const;
};

}  // namespace greenloop::offline
