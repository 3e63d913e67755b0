#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace greenloop::firmware {

/// What steps of impulses take.
struct MovingTiming {
  std::uint32_t state_worst = 0;  ///< instructions of a step without displacements
  std::uint32_t frame_worst = 0;  ///< of one with those of all vertices by all modes
  std::uint64_t state_work = 0;   ///< units declared for the first
  std::uint64_t frame_work = 0;   ///< and for the second
  std::uint32_t modes = 0, vertices = 0;
  bool ran = false;  ///< every step was answered
};

/// Plays impulses on a model. field: memory for 3 floats a vertex. slow: every step is made ten times, a negative
/// control.
[[nodiscard]] MovingTiming time_moving(std::span<const std::byte> model, std::span<std::byte> arena,
                                       std::span<float> field, bool slow);

}  // namespace greenloop::firmware
