#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace greenloop::firmware {

/// What steps of a ball that presses and rubs take.
struct TouchingTiming {
  std::uint32_t cycles = 0;
  std::uint32_t median = 0, worst = 0;  ///< instructions of a step in which it touches
  std::uint32_t touching = 0;           ///< steps in which it does
  std::uint32_t finest = 0;             ///< of those, answered at the finest level
  std::uint32_t most_contacts = 0;      ///< places that may touch, at once
  std::uint64_t least_work = 0;         ///< units, declared: the budget
  std::uint64_t most_work = 0;          ///< units, of a step
  std::size_t arena_bytes = 0;
  float most_force = 0;     ///< N
  float most_residual = 0;  ///< of the laws of contact
  bool ran = false;         ///< every step was answered within its budget
};

/// A ball with friction goes 1 cm to and fro over a body, up to 4 mm deep, with the
/// least budget that is declared. slow: every step is made ten times, a
/// negative control.
[[nodiscard]] TouchingTiming time_touching(std::span<const std::byte> model, std::span<std::byte> arena, bool slow);

}  // namespace greenloop::firmware
