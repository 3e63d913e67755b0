#pragma once

#include <cstdint>

namespace greenloop {

/// What the control loop answers to a DragState: drag_command.lcm.
struct DragCommand {
  std::int64_t cycle = 0;   ///< of the state it answers
  std::int64_t work = 0;    ///< units spent
  std::int64_t budget = 0;  ///< units allowed
  std::int32_t status = 0;  ///< greenloop::Status
  std::int32_t cycles = 0;  ///< of multigrid, in this step
  float residual = 0;       ///< relative
  float force[3] = {};      ///< N, with which the tool acts on the body
  std::int64_t digest = 0;  ///< FNV-1a 64 over all responses up to this one, as two's complement
};

}  // namespace greenloop
