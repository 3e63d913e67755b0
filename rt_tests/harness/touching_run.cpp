#include "rt_tests/harness/touching_run.hpp"

#include <bit>

#include "rt_tests/harness/touching_checks.hpp"
#include "rt_tests/harness/touching_script.hpp"
#include "runtime/algebra/fnv1a.hpp"

namespace greenloop {
namespace {

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
    if (report.touching_work > created.body.touching_work(cycle.tools) || report.touching_work > need.touching_work) {
      run.error = "finding contacts took more than it may";
    }
    if (!may_be(report.status, cycle, need.least_work)) run.error = "a step was refused that should not be";
    if (!answered(report.status) && now != last) run.error = "a refused step changed the answer";
    if (answered(report.status) && run.error == nullptr) run.error = check_touching(created.body, cycle.tools, run);
    last = now;
  }
  run.digest = digest.value();
  return run;
}

}  // namespace greenloop
