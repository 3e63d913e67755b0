#pragma once

#include <bit>
#include <cstdint>

namespace greenloop {

/// How many values lie in each of some ranges, none longer than a 32nd of what is in it: a bound of the sum of the
/// largest without keeping them. Values below 64 times 2^octaves are told apart like that; larger ones count as the
/// largest of all.
template <std::uint32_t octaves = 16>
class ValueCounts {
 public:
  void add(std::uint64_t value) noexcept {
    ++count_[range_of(value)];
    most_ = value > most_ ? value : most_;
  }

  [[nodiscard]] std::uint64_t most() const noexcept { return most_; }

  /// Bound of the sum of the `count` largest, no more than a 32nd above it; of all, if there are fewer.
  [[nodiscard]] std::uint64_t largest(std::uint64_t count) const noexcept {
    std::uint64_t sum = 0;
    for (std::uint64_t range = ranges; count > 0 && range-- > 0;) {
      const std::uint64_t here = count_[range] < count ? count_[range] : count;
      sum += here * largest_of(range);
      count -= here;
    }
    return sum;
  }

 private:
  static constexpr std::uint64_t parts = 32;                      // of an octave
  static constexpr std::uint64_t ranges = (octaves + 2) * parts;  // the last one has all larger ones too

  static constexpr std::uint64_t range_of(std::uint64_t value) noexcept {
    const auto octave = static_cast<std::uint64_t>(std::bit_width(value / (2 * parts)));
    const std::uint64_t range = octave * parts + (value >> octave);
    return range < ranges ? range : ranges - 1;
  }

  [[nodiscard]] std::uint64_t largest_of(std::uint64_t range) const noexcept {
    const std::uint64_t octave = range < 2 * parts ? 0 : range / parts - 1;
    const std::uint64_t end = (range - octave * parts + 1) << octave;
    return range + 1 == ranges || end > most_ ? most_ : end - 1;
  }

  std::uint32_t count_[ranges] = {};
  std::uint64_t most_ = 0;
};

}  // namespace greenloop
