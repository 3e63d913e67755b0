#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "formats/layout.hpp"
#include "runtime/loop.hpp"

namespace greenloop {

/// Steps by what came of them.
struct AnswerCounts {
  std::array<std::uint64_t, statuses> by_status{};
  std::array<std::uint64_t, layout::max_levels> by_level{};  ///< answers by the level of the constraints
  std::uint64_t cached = 0;   ///< answers from what was kept of an earlier step, unchanged
  std::uint64_t changed = 0;  ///< answers from what was kept and changed
  std::uint64_t waiting = 0;  ///< answers with new constraints that wait
  std::uint64_t refined = 0;  ///< answers at a finer level than the last, prepared in steps before
  std::uint64_t work = 0;     ///< units in all
  std::uint64_t worst_work = 0;

  [[nodiscard]] std::uint64_t of(Status status) const { return by_status[static_cast<std::size_t>(status)]; }
  [[nodiscard]] std::uint64_t answers() const { return of(Status::ok) + of(Status::coarser); }
  [[nodiscard]] std::uint64_t refusals() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : by_status) {
      sum += count;
    }
    return sum - answers();
  }
};

}  // namespace greenloop
