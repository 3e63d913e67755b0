#pragma once

#include <cstdint>

namespace greenloop {

/// What the device gives a scene of motions in a cycle of the loop: impulse_state.lcm.
struct ImpulseState {
  std::int64_t cycle = 0;     ///< 0, 1, 2, ...
  std::int32_t impulse = -1;  ///< of the model's palette, by its number; -1: none
};

}  // namespace greenloop
