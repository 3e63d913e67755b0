#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace greenloop {

/// Times in cyclictest's conventions: bins of one microsecond from 0 on, a count of what is beyond them, and least,
/// average and most of all.
class TimeHistogram {
 public:
  TimeHistogram() = default;

  /// Up to `bins` microseconds.
  explicit TimeHistogram(std::size_t bins) : count_(bins) {}

  /// us: at least 0.
  void add(double us) {
    const auto bin = static_cast<std::size_t>(us);
    ++(bin < count_.size() ? count_[bin] : overflows_);
    least_ = total_ == 0 ? us : std::min(least_, us);
    most_ = std::max(most_, us);
    sum_ += us;
    ++total_;
  }

  [[nodiscard]] const std::vector<std::uint64_t>& count() const { return count_; }
  [[nodiscard]] std::uint64_t overflows() const { return overflows_; }
  [[nodiscard]] std::uint64_t total() const { return total_; }
  /// Upper end, in microseconds, of the bin that a share of the times, 0..1, lies at or below; the largest time if it
  /// lies beyond the bins.
  [[nodiscard]] double quantile(double share) const {
    const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(total_)));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < count_.size(); ++bin) {
      seen += count_[bin];
      if (seen >= wanted) {
        return std::min(static_cast<double>(bin + 1), most_);
      }
    }
    return most_;
  }

  [[nodiscard]] double least() const { return least_; }
  [[nodiscard]] double average() const { return total_ == 0 ? 0 : sum_ / static_cast<double>(total_); }
  [[nodiscard]] double most() const { return most_; }

 private:
  std::vector<std::uint64_t> count_;
  std::uint64_t overflows_ = 0, total_ = 0;
  double least_ = 0, sum_ = 0, most_ = 0;
};

}  // namespace greenloop
