#pragma once

#include <algorithm>
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
  [[nodiscard]] double least() const { return least_; }
  [[nodiscard]] double average() const { return total_ == 0 ? 0 : sum_ / static_cast<double>(total_); }
  [[nodiscard]] double most() const { return most_; }

 private:
  std::vector<std::uint64_t> count_;
  std::uint64_t overflows_ = 0, total_ = 0;
  double least_ = 0, sum_ = 0, most_ = 0;
};

}  // namespace greenloop
