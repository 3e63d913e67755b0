#pragma once

#include <cstdint>
#include <span>

#include "rt_tests/harness/touching_script.hpp"
#include "runtime/contact_body.hpp"

namespace greenloop {

/// What was met in answers that were checked.
struct TouchCounts {
  std::uint64_t contacts = 0;  ///< with a force, in all
  std::uint64_t slipping = 0;  ///< of these
  double most_over_cone = 0;   ///< largest friction force over its bound, less 1
};

/// What is wrong with the last answer of a body to these tools: forces that pull, leave their cones or are not finite,
/// that are not the sums of their contacts', displacements that are not finite. Null: nothing. Without heap.
[[nodiscard]] const char* check_touching(const ContactBody& body, std::span<const ContactBody::ToolInput> tools,
                                         TouchCounts& counts) noexcept;

/// Whether a cycle may have such a status; enough: Requirement::least_work.
[[nodiscard]] bool may_be(Status status, const TouchingScript::Cycle& cycle, std::uint64_t enough) noexcept;

}  // namespace greenloop
