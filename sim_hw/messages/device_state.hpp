#pragma once

#include <cstdint>

namespace greenloop {

inline constexpr std::uint32_t max_tools = 8;  ///< of a device

/// What the encoders of one tool say.
struct ToolState {
  static constexpr std::int32_t unit = 32767;

  std::int32_t position[3] = {};                  ///< encoder counts of its centre
  std::int16_t orientation[4] = {unit, 0, 0, 0};  ///< quaternion w, x, y, z times `unit`
};

/// What the haptic device measured at the start of a cycle of the loop: device_state.lcm with room for the most tools,
/// so that threads may hand it over without heap.
struct DeviceState {
  std::int64_t cycle = 0;       ///< 0, 1, 2, ...
  double resolution = 0;        ///< m of the body per encoder count
  double origin[3] = {};        ///< m, where all counts are zero, in the frame of the body
  double gravity[3] = {};       ///< m/s^2, in the frame of the body
  std::int32_t impulse = -1;    ///< of the palette of the body's motions, by its number; -1: none
  std::uint32_t num_tools = 0;  ///< 0..max_tools
  ToolState tools[max_tools] = {};
};

}  // namespace greenloop
