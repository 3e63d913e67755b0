#include "rt_tests/firmware/image/touching.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "rt_tests/firmware/image/instruction_clock.hpp"
#include "runtime/contact_body.hpp"
#include "runtime/testing/touchable_nodes.hpp"

namespace greenloop::firmware {
namespace {

constexpr std::uint32_t cycles = 1000;
constexpr std::uint64_t refining_work = 100'000;  // units, so that no step prepares much beside what it answers
constexpr double radius = 8e-3, deepest = 4e-3, path = 10e-3;  // m

std::array<std::uint32_t, cycles> taken;

Double3 highest_node(const ModelView& view) {
  Double3 highest;
  bool first = true;
  visit_touchable(view, [&](std::uint32_t, const layout::NodeRecord& node) {
    const Double3 place{node.position[0], node.position[1], node.position[2]};
    if (first || place.z > highest.z) highest = place;
    first = false;
  });
  return highest;
}

// from 0 to 1 and back, `turns` times in all cycles
double to_and_fro(std::uint32_t cycle, std::uint32_t turns) {
  const std::uint32_t period = cycles / turns, at = cycle % period;
  return static_cast<double>(std::min(at, period - at)) / (period / 2);
}

Tool ball_at(const Double3& top, std::uint32_t cycle) {
  const double along = path * (to_and_fro(cycle, 4) - 0.5);
  const double depth = deepest * to_and_fro(cycle, 1);
  Tool tool{Shape::sphere(radius), {}};
  tool.pose.position = {top.x + along, top.y, top.z + radius - depth};
  return tool;
}

}  // namespace

TouchingTiming time_touching(std::span<const std::byte> model, std::span<std::byte> arena, bool slow) {
  TouchingTiming timing;
  const auto opened = Model::open(model);
  if (!opened) return timing;
  const ContactBody::Limits limits{.elastostatic = {.max_contacts = 4,
                                                    .cached_factors = 1,
                                                    .refining_work = refining_work,
                                                    .iterations = 4,
                                                    .prices = cortex_m7_prices()},
                                   .max_tools = 1,
                                   .max_points = 1};
  const auto need = ContactBody::required(opened.model, limits);
  timing.arena_bytes = need.bytes;
  timing.least_work = need.least_work;
  auto created = ContactBody::create(opened.model, limits, arena);
  if (!created) return timing;
  const Double3 top = highest_node(opened.model.view());
  timing.ran = true;
  for (; timing.cycles < cycles; ++timing.cycles) {
    const ContactBody::ToolInput tools[] = {{ball_at(top, timing.cycles), 0.3}};
    ContactBody::StepReport report;
    const std::uint64_t begin = instructions();
    for (int repeated = slow ? 10 : 1; repeated > 0; --repeated) {
      report = created.body.step(tools, {}, {need.least_work});
    }
    const auto counted = static_cast<std::uint32_t>(instructions() - begin);
    timing.ran &= answered(report.status) && report.work <= need.least_work && report.left_out == 0;
    timing.most_work = std::max(timing.most_work, report.work);
    const ContactBody::ToolAnswer& ball = created.body.tools()[0];
    if (ball.contacts == 0) continue;
    taken[timing.touching++] = counted;
    timing.finest += report.status == Status::ok ? 1 : 0;
    timing.most_contacts = std::max(timing.most_contacts, ball.contacts);
    timing.most_force = std::max(timing.most_force, static_cast<float>(norm(ball.force)));
    timing.most_residual = std::max(timing.most_residual, report.residual);
  }
  std::sort(taken.begin(), taken.begin() + timing.touching);
  timing.ran &= timing.touching > 0;
  timing.median = timing.ran ? taken[timing.touching / 2] : 0;
  timing.worst = timing.ran ? taken[timing.touching - 1] : 0;
  return timing;
}

}  // namespace greenloop::firmware
