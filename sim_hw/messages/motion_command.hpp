#pragma once

#include <cstdint>

#include "formats/layout/impulse_response.hpp"

namespace greenloop {

/// What the control loop answers to an ImpulseState: motion_command.lcm with room for the most modes, so that threads
/// may hand it over without heap.
struct MotionCommand {
  std::int64_t cycle = 0;                     ///< of the state it answers
  std::int64_t work = 0;                      ///< units spent
  std::int64_t budget = 0;                    ///< units allowed
  std::int32_t status = 0;                    ///< greenloop::Status
  std::int32_t orbit = 0;                     ///< that is played; 0: the scene at rest
  std::int32_t row = 0;                       ///< of the model: the state that was last passed
  std::int32_t rank = 0;                      ///< modes in the displacements of this cycle; 0: it had none
  std::int64_t digest = 0;                    ///< FNV-1a 64 over all responses up to this one, as two's complement
  std::uint32_t num_modes = 0;                ///< 0..layout::most_modes
  float coordinate[layout::most_modes] = {};  ///< m, q_u
};

}  // namespace greenloop
