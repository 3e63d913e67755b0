#pragma once

#include <cstdint>

namespace greenloop {

/// A person who pushes a scene of motions: an impulse every third of a second or so, now and then several in a row,
/// while the last still dies out; one in twenty is none of the palette, and whether one may follow is not asked. The
/// same in every run by its seed.
class ImpulseSchedule {
 public:
  static constexpr std::int32_t none = -1;

  /// Of no impulse.
  ImpulseSchedule() = default;
  /// impulses: of the palette, at least 1; rate: Hz.
  ImpulseSchedule(std::uint32_t impulses, double rate, std::uint64_t seed = 1)
      : impulses_(impulses), rate_(rate), random_(2 * seed + 1) {}

  /// What is given in a cycle, or `none`; to be asked of 0, 1, 2, ... once each.
  [[nodiscard]] std::int32_t next(std::int64_t cycle);

 private:
  [[nodiscard]] std::uint32_t below(std::uint32_t bound);

  std::uint32_t impulses_ = 0;
  double rate_ = 0;  ///< Hz
  std::uint64_t random_ = 0;
  std::int64_t due_ = 0;     ///< cycle of the next impulse
  std::uint32_t burst_ = 0;  ///< impulses that follow it in a row
};

}  // namespace greenloop
