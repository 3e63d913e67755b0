#include "offline/compress/field_thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "offline/compress/field_error.hpp"

namespace greenloop::offline {
namespace {

constexpr double peak_share = 0.6;  // of the worst column's error, which several blocks dropped at one place add up to
constexpr double least_spread = 1e-6, most_spread = 0.2;
constexpr int bisections = 12;

double norm(const double* block) {
  double sum = 0;
  for (int k = 0; k < 9; ++k) sum += block[k] * block[k];
  return std::sqrt(sum);
}

}  // namespace

FieldSample::FieldSample(const CompressedCompliance& compliance, FieldRows read,
                         const std::vector<SampleColumn>& columns)
    : wavelet_(compliance.wavelet()), read_(std::move(read)), exact_(columns) {
  const std::size_t finest = compliance.finest(), rows = compliance.rows(finest);
  for (std::size_t level = 0; level <= finest; ++level) {
    level_weight_.resize(compliance.rows(level), std::ldexp(1.0, -static_cast<int>(level)));
  }
  std::vector<double> unit(9 * rows, 0.0);
  for (const auto& column : columns) {
    Column made{.coefficients = std::vector<double>(9 * rows)};
    double* own = unit.data() + 9 * column.row;
    own[0] = own[4] = own[8] = 1;
    compliance.apply_to_coefficients(finest, 3, unit.data(), made.coefficients.data());
    own[0] = own[4] = own[8] = 0;
    auto displaced = made.coefficients;
    for (std::size_t level = 1; level <= finest; ++level) wavelet_.merge(level, 9, displaced.data());
    made.own = norm(displaced.data() + 9 * column.row);
    for (std::size_t i = 0; i < rows; ++i) {
      if (read_.coefficients[i] == 0) std::fill_n(made.coefficients.data() + 9 * i, 9, 0.0);
      const double weighted = level_weight_[i] * norm(made.coefficients.data() + 9 * i);
      made.spread_norm += weighted * weighted;
    }
    made.spread_norm = std::sqrt(made.spread_norm);
    columns_.push_back(std::move(made));
  }
}

std::vector<double> FieldSample::keep(std::size_t column, const FieldThresholds& thresholds,
                                      std::uint32_t& kept) const {
  const Column& from = columns_[column];
  std::vector<double> x(from.coefficients.size(), 0.0);
  kept = 0;
  for (std::size_t i = 0; i < level_weight_.size(); ++i) {
    const double* block = from.coefficients.data() + 9 * i;
    const double size = norm(block);
    const bool wanted =
        level_weight_[i] * size >= thresholds.spread * from.spread_norm || size >= thresholds.peak * from.own;
    if (size == 0 || !wanted) continue;
    std::copy_n(block, 9, x.data() + 9 * i);
    ++kept;
  }
  for (std::size_t level = 1; level <= wavelet_.finest(); ++level) wavelet_.merge(level, 9, x.data());
  return x;
}

FieldSample::Outcome FieldSample::measure(const FieldThresholds& thresholds) const {
  FieldError error(read_.nodes);
  Outcome outcome;
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    std::uint32_t kept = 0;
    error.add(keep(j, thresholds, kept), exact_[j].exact.data(), exact_[j].area);
    outcome.longest = std::max(outcome.longest, kept);
  }
  outcome.rms = error.rms();
  outcome.worst_column = error.worst_column();
  return outcome;
}

FieldThresholds FieldSample::choose(double rms, double worst_column) const {
  FieldThresholds chosen;
  double fails = most_spread, meets = least_spread;
  for (int step = 0; step <= bisections; ++step) {
    const FieldThresholds trial{.spread = step == 0 ? meets : std::sqrt(fails * meets),
                                .peak = peak_share * worst_column};
    const Outcome outcome = measure(trial);
    if (outcome.rms <= rms && outcome.worst_column <= worst_column) {
      chosen = trial;
      meets = trial.spread;
    } else if (step == 0) {
      break;
    } else {
      fails = trial.spread;
    }
  }
  return chosen;
}

}  // namespace greenloop::offline
