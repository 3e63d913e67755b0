#pragma once

#include <cstdint>

#include "rt_tests/gel_pad/indenters.hpp"
#include "rt_tests/gel_pad/upper_side.hpp"
#include "runtime/model.hpp"

namespace greenloop::gel_pad {

/// What the loop answers to an indenter that was pressed into a model of the pad and then held.
struct PressedPad : Pressed {
  SideField down;              ///< m, how far the upper side went along its normal
  std::uint32_t contacts = 0;  ///< places that are pushed
  double settled = 0;          ///< by how much the force changed in the last step, of itself
};

/// Presses in `steps` steps, without friction, then holds still for as many. Throws std::runtime_error if a step is not
/// answered whole, or the nodes of the pad's upper side are no grid.
[[nodiscard]] PressedPad press_in_loop(const Model& model, const Indenter& indenter, int steps);

}  // namespace greenloop::gel_pad
