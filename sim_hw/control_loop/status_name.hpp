#pragma once

#include "runtime/loop.hpp"

namespace greenloop {

/// As logs and reports call it.
[[nodiscard]] constexpr const char* name(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::coarser:
      return "coarser";
    case Status::held_not_finite:
      return "held_not_finite";
    case Status::held_out_of_range:
      return "held_out_of_range";
    case Status::held_not_touchable:
      return "held_not_touchable";
    case Status::held_duplicate:
      return "held_duplicate";
    case Status::held_response_size:
      return "held_response_size";
    case Status::held_over_budget:
      return "held_over_budget";
    case Status::held_singular:
      return "held_singular";
    case Status::held_overflow:
      return "held_overflow";
    case Status::held_unsupported:
      return "held_unsupported";
    case Status::held_bad_surface:
      return "held_bad_surface";
    case Status::held_unsolved:
      return "held_unsolved";
    case Status::held_illegal_impulse:
      return "held_illegal_impulse";
  }
  return "unknown";
}

}  // namespace greenloop
