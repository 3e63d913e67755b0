#include "rt_tests/harness/touching_checks.hpp"

#include <cmath>

namespace greenloop {
namespace {

// of the cone's bound: what turning a normal into single precision changes
constexpr double rounding = 5e-7;

bool is_finite(const Double3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

const char* check_touching(const ContactBody& body, std::span<const ContactBody::ToolInput> tools,
                           TouchCounts& counts) noexcept {
  Double3 sum[TouchingScript::most_tools];
  for (const ContactBody::Contact& contact : body.contacts()) {
    if (contact.tool >= tools.size()) return "a contact is of no tool";
    if (!is_finite(contact.force) || !is_finite(contact.position)) return "a contact is not finite";
    sum[contact.tool] += -contact.force;
    const double pressed = dot(contact.force, contact.normal);
    const double along = norm(contact.force - pressed * contact.normal);
    const double most = tools[contact.tool].friction * pressed;
    if (!(pressed >= 0)) return "a contact pulls";
    const double least = rounding * (pressed + tools[contact.tool].friction * norm(contact.force));
    if (!(along <= most + least)) return "a friction force is outside of its cone";
    if (contact.state == ContactState::open && !(norm(contact.force) == 0)) return "an open contact has a force";
    if (most > 0 && along / most - 1 > counts.most_over_cone) counts.most_over_cone = along / most - 1;
    counts.contacts += pressed > 0 ? 1 : 0;
    counts.slipping += contact.state == ContactState::slip ? 1 : 0;
  }
  if (body.tools().size() != tools.size()) return "tools are missing from the answer";
  for (std::size_t t = 0; t < tools.size(); ++t) {
    const ContactBody::ToolAnswer& answer = body.tools()[t];
    if (!is_finite(answer.force) || !is_finite(answer.torque)) return "what a tool feels is not finite";
    if (!(norm(answer.force - sum[t]) <= 1e-12 * norm(sum[t]))) return "a tool's force is not that of its contacts";
    if (answer.fault != ToolFault::none && answer.contacts > 0) return "a tool that is left out touches";
  }
  for (const Vec4& u : body.displacement()) {
    if (!std::isfinite(u.x + u.y + u.z)) return "a displacement is not finite";
  }
  return nullptr;
}

bool may_be(Status status, const TouchingScript::Cycle& cycle, std::uint64_t enough) noexcept {
  switch (status) {
    case Status::held_over_budget:
      return cycle.budget.work < enough;
    case Status::held_out_of_range:
      return cycle.tools.size() > TouchingScript::most_tools;
    case Status::held_not_finite:
    case Status::held_bad_surface:
    case Status::held_overflow:
    case Status::held_unsolved:
      return !cycle.is_sound;
    default:
      return answered(status);
  }
}

}  // namespace greenloop
