#include "rt_tests/harness/touching_run.hpp"

#include <bit>
#include <cmath>

#include "rt_tests/harness/touching_script.hpp"
#include "runtime/algebra/fnv1a.hpp"

namespace greenloop {
namespace {

// of the cone's bound: what turning a normal into single precision changes
constexpr double rounding = 1e-6;

bool is_finite(const Double3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void add(const Double3& v, Fnv1a& digest) {
  for (const double x : {v.x, v.y, v.z}) digest.add_word(std::bit_cast<std::uint64_t>(x));
}

void add_answer(const ContactBody& body, Fnv1a& digest) {
  for (const ContactBody::ToolAnswer& answer : body.tools()) {
    digest.add_word(static_cast<std::uint64_t>(answer.fault));
    digest.add_word(answer.contacts);
    digest.add_word(std::bit_cast<std::uint64_t>(answer.depth));
    add(answer.force, digest);
    add(answer.torque, digest);
  }
  for (const ContactBody::Contact& contact : body.contacts()) {
    for (const std::uint32_t node : contact.node) digest.add_word(node);
    digest.add_word(static_cast<std::uint64_t>(contact.state));
    digest.add_word(std::bit_cast<std::uint64_t>(contact.gap));
    add(contact.position, digest);
    add(contact.normal, digest);
    add(contact.force, digest);
  }
  for (const Vec4& u : body.displacement()) {
    for (const float x : {u.x, u.y, u.z, u.w}) digest.add_word(std::bit_cast<std::uint32_t>(x));
  }
}

void add_report(const ContactBody::StepReport& report, Fnv1a& digest) {
  digest.add_word(static_cast<std::uint64_t>(report.status));
  digest.add_word(report.refused);
  digest.add_word(report.work);
  digest.add_word(report.touching_work);
  digest.add_word(report.constraint_level);
  digest.add_word(report.field_level);
  digest.add_word(report.iterations);
  digest.add_word(std::bit_cast<std::uint32_t>(report.residual));
  digest.add_word(report.left_out);
  digest.add_word(std::bit_cast<std::uint64_t>(report.deepest_left_out));
}

std::uint64_t digest_of(const ContactBody& body) {
  Fnv1a digest;
  add_answer(body, digest);
  return digest.value();
}

// what is wrong with an answer; null: nothing
const char* check_answer(const ContactBody& body, std::span<const ContactBody::ToolInput> tools, TouchingRun& run) {
  Double3 sum[TouchingScript::most_tools];
  for (const ContactBody::Contact& contact : body.contacts()) {
    if (contact.tool >= tools.size()) return "a contact is of no tool";
    if (!is_finite(contact.force) || !is_finite(contact.position)) return "a contact is not finite";
    sum[contact.tool] += -contact.force;
    const double pressed = dot(contact.force, contact.normal);
    const double along = norm(contact.force - pressed * contact.normal);
    const double most = tools[contact.tool].friction * pressed;
    if (!(pressed >= 0)) return "a contact pulls";
    if (!(along <= most + rounding * pressed)) return "a friction force is outside of its cone";
    if (contact.state == ContactState::open && !(norm(contact.force) == 0)) return "an open contact has a force";
    if (most > 0 && along / most - 1 > run.most_over_cone) run.most_over_cone = along / most - 1;
    run.contacts += pressed > 0 ? 1 : 0;
    run.slipping += contact.state == ContactState::slip ? 1 : 0;
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

// whether such a cycle may be refused so
bool may_be(Status status, const TouchingScript::Cycle& cycle, std::uint64_t enough) {
  switch (status) {
    case Status::held_over_budget:
      return cycle.budget.work < enough;
    case Status::held_out_of_range:
      return cycle.tools.size() > TouchingScript::most_tools;
    case Status::held_not_finite:
    case Status::held_bad_surface:
    case Status::held_overflow:
      return !cycle.is_sound;
    default:
      return answered(status);
  }
}

}  // namespace

TouchingRun run_touching_script(const Model& model, const ContactBody::Limits& limits, std::span<std::byte> memory,
                                std::uint64_t cycles, std::uint64_t seed, bool flip) noexcept {
  TouchingRun run;
  const ContactBody::Requirement need = ContactBody::required(model, limits);
  run.memory_bytes = need.bytes;
  auto created = ContactBody::create(model, limits, memory);
  if (!created) {
    run.error = "the body was not created";
    return run;
  }
  TouchingScript script(model, need, seed);
  Fnv1a digest;
  std::uint64_t last = digest_of(created.body);
  for (; run.cycle < cycles && run.error == nullptr; ++run.cycle) {
    const TouchingScript::Cycle cycle = script.next(created.body);
    const ContactBody::StepReport report = created.body.step(cycle.tools, {}, cycle.budget);
    ++run.by_status[static_cast<std::size_t>(report.status)];
    add_report(report, digest);
    const std::uint64_t now = digest_of(created.body);
    digest.add_word(now ^ (flip && run.cycle == cycles / 2 ? 1U : 0U));
    if (report.work > cycle.budget.work) run.error = "a step took more than its budget";
    if (report.touching_work > created.body.touching_work(cycle.tools)) {
      run.error = "finding contacts took more than it may";
    }
    if (!may_be(report.status, cycle, need.least_work)) run.error = "a step was refused that should not be";
    if (!answered(report.status) && now != last) run.error = "a refused step changed the answer";
    if (answered(report.status) && run.error == nullptr) run.error = check_answer(created.body, cycle.tools, run);
    last = now;
  }
  run.digest = digest.value();
  return run;
}

}  // namespace greenloop
