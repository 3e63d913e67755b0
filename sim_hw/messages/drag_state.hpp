#pragma once

#include <cstdint>

namespace greenloop {

/// What a tool that drags a soft body does in a cycle of the loop: drag_state.lcm.
struct DragState {
  std::int64_t cycle = 0;    ///< 0, 1, 2, ...
  std::int32_t vertex = -1;  ///< of the model, that the tool holds; -1: none
  double travel[3] = {};     ///< m, from where the tool took hold of it
};

}  // namespace greenloop
