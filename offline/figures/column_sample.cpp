#include "offline/figures/column_sample.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace greenloop::offline {
namespace {

constexpr std::size_t least_rows = 16;  // of a level

// the first `count` of 0 .. size - 1 in van der Corput's order
std::vector<std::size_t> spread(std::size_t size, std::size_t count) {
  std::size_t bits = 0;
  while ((std::size_t{1} << bits) < size) ++bits;
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; chosen.size() < count; ++k) {
    std::size_t reversed = 0;
    for (std::size_t bit = 0; bit < bits; ++bit) reversed |= ((k >> bit) & 1) << (bits - 1 - bit);
    if (reversed < size) chosen.push_back(reversed);
  }
  return chosen;
}

// A total over all rows and the square of its standard error.
struct Total {
  double value = 0, variance = 0;
};

// `quantity(column)`
template <class Quantity>
Total total(const std::vector<Stratum>& strata, const std::vector<std::vector<CompressedColumn>>& columns,
            Quantity quantity) {
  Total result;
  for (std::size_t s = 0; s < strata.size(); ++s) {
    const auto size = static_cast<double>(strata[s].size), count = static_cast<double>(columns[s].size());
    double sum = 0, squares = 0;
    for (const CompressedColumn& column : columns[s]) sum += quantity(column);
    const double mean = sum / count;
    for (const CompressedColumn& column : columns[s]) squares += std::pow(quantity(column) - mean, 2);
    result.value += size * mean;
    if (count < size) result.variance += size * (size - count) * squares / (count * (count - 1));
  }
  return result;
}

double worst(const std::vector<std::vector<CompressedColumn>>& columns, std::size_t threshold) {
  double most = 0;
  for (const auto& stratum : columns) {
    for (const CompressedColumn& column : stratum) most = std::max(most, column.trials[threshold].worst);
  }
  return most;
}

}  // namespace

std::vector<Stratum> stratified_sample(const SurfaceWavelet& wavelet, std::size_t count) {
  std::vector<Stratum> strata;
  for (std::size_t level = 0; level <= wavelet.finest(); ++level) {
    const std::size_t begin = level == 0 ? 0 : wavelet.row_end(level - 1), size = wavelet.row_end(level) - begin;
    if (size == 0) continue;
    const std::size_t share = (size * count + wavelet.rows() - 1) / wavelet.rows();
    strata.push_back({.size = size, .rows = spread(size, std::min(size, std::max(share, least_rows)))});
    for (std::size_t& row : strata.back().rows) row += begin;
  }
  return strata;
}

std::vector<std::size_t> interleaved(const std::vector<Stratum>& strata) {
  std::vector<std::pair<double, std::size_t>> rows;  // place in its stratum, row
  for (const Stratum& stratum : strata) {
    for (std::size_t i = 0; i < stratum.rows.size(); ++i) {
      rows.emplace_back(static_cast<double>(i) / static_cast<double>(stratum.rows.size()), stratum.rows[i]);
    }
  }
  std::sort(rows.begin(), rows.end());
  std::vector<std::size_t> order;
  for (const auto& [place, row] : rows) order.push_back(row);
  return order;
}

std::vector<SampledRate> estimate_rates(const std::vector<Stratum>& strata,
                                        const std::vector<std::vector<CompressedColumn>>& columns,
                                        const std::vector<double>& thresholds) {
  double rows = 0;
  for (const Stratum& stratum : strata) rows += static_cast<double>(stratum.size);
  const double exact = total(strata, columns, [](const CompressedColumn& column) { return column.exact_energy; }).value;
  std::vector<SampledRate> rates;
  for (std::size_t t = 0; t < thresholds.size(); ++t) {
    const Total kept = total(
        strata, columns, [t](const CompressedColumn& column) { return static_cast<double>(column.trials[t].kept); });
    const double error =
        total(strata, columns, [t](const CompressedColumn& column) { return column.trials[t].error_energy; }).value;
    const double square = error / exact;
    // the quotient's error is that of what its numerator has besides `square` times the denominator
    const Total residual = total(strata, columns, [t, square](const CompressedColumn& column) {
      return column.trials[t].error_energy - square * column.exact_energy;
    });
    SampledRate rate;
    rate.point.threshold = thresholds[t];
    rate.point.ratio = rows * rows / kept.value;
    rate.point.rms = std::sqrt(square);
    rate.point.worst_column = worst(columns, t);
    rate.ratio_error = std::sqrt(kept.variance) / kept.value;
    rate.rms_error = error > 0 ? 0.5 * std::sqrt(residual.variance) / error : 0;
    rates.push_back(rate);
  }
  return rates;
}

}  // namespace greenloop::offline
