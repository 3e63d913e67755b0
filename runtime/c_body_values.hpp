#pragma once

#include <cstddef>
#include <span>

#include "runtime/contact_body.hpp"
#include "runtime/greenloop_contact.h"
#include "runtime/greenloop_impulse.h"
#include "runtime/impulse_response.hpp"

// What the functions of greenloop_contact.h and greenloop_impulse.h are given and give, in C++; for their sources and
// those of greenloop_vibrating.h alone.

namespace greenloop {

[[nodiscard]] ContactBody::ToolInput tool_of(const greenloop_tool& tool) noexcept;

/// The tools of a step; of too many one more than any body takes, so that it refuses them.
struct Tools {
  static constexpr std::size_t most = 16;

  Tools(const greenloop_tool* tools, std::size_t tool_count) : count(tool_count <= most ? tool_count : most + 1) {
    for (std::size_t t = 0; t < count; ++t) tool[t] = tool_of(tools[t]);
  }
  [[nodiscard]] std::span<const ContactBody::ToolInput> all() const { return {tool, count}; }

  std::size_t count;
  ContactBody::ToolInput tool[most + 1];
};

[[nodiscard]] ContactBody::Limits touched_limits_of(const greenloop_contact_body_limits& limits) noexcept;
/// None if null.
[[nodiscard]] Elastostatic::Loads acting(const greenloop_loads* loads) noexcept;
[[nodiscard]] greenloop_contact_body_report touch_report_of(const ContactBody::StepReport& report) noexcept;

[[nodiscard]] ImpulseResponse::Limits moving_limits_of(const greenloop_impulse_response_limits& limits) noexcept;
[[nodiscard]] greenloop_impulse_response_report motion_report_of(const ImpulseResponse::StepReport& report) noexcept;

}  // namespace greenloop
