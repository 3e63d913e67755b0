#include "rt_tests/firmware/image/timed_loop.hpp"

#include <algorithm>

#include "rt_tests/firmware/image/instruction_clock.hpp"

namespace greenloop::firmware {
namespace {

constexpr std::uint32_t period = 400'000;  // instructions: 1 ms at 400 MHz, one instruction a cycle

struct Loop {
  Solver* body = nullptr;
  Budget budget;
  std::span<const std::uint32_t> nodes;
  std::span<float> field;
  Motion motion{};
  std::uint32_t steps_per_cycle = 1;
  Timing timing;
  AnswerCounts counts;
  std::array<Constraint, contacts_per_step> contact{};
  std::array<float, 3 * contacts_per_step> force{};
  std::array<std::uint32_t, timed_cycles> instructions{};
};

Loop loop;
volatile std::uint32_t cycle;

void move_contacts() {
  const std::uint32_t first = loop.motion.cycles_per_node == 0 ? 0 : cycle / loop.motion.cycles_per_node;
  for (std::uint32_t i = 0; i < contacts_per_step; ++i) {
    const float depth = 0x1p-18F * static_cast<float>(cycle + i + 1);
    loop.contact[i] = {loop.nodes[(first + i) % loop.nodes.size()], {depth, -depth, depth / 2}};
  }
}

void note(const Solver::StepReport& report, std::uint32_t instructions) {
  ImageDriver::count(report, report, loop.counts);
  Timing& timing = loop.timing;
  if (report.status == Status::ok && timing.finest++ == 0) {
    timing.refined = cycle;
  }
  loop.instructions[cycle] = instructions;
}

void run_cycle() {
  move_contacts();
  Solver::StepReport report;
  const std::uint64_t begin = instructions();
  for (std::uint32_t k = 0; k < loop.steps_per_cycle; ++k) {
    report = loop.body->step(loop.contact, loop.budget, {as_vec3(loop.force), as_vec4(loop.field)});
  }
  note(report, static_cast<std::uint32_t>(instructions() - begin));
  loop.timing.late += periodic_interrupt_waits() ? 1 : 0;
  cycle = cycle + 1;
}

}  // namespace

extern "C" void timer_interrupt() {
  if (cycle < timed_cycles) {
    run_cycle();
  }
}

Timing run_timed_loop(Solver& body, Budget budget, std::span<const std::uint32_t> nodes, std::span<float> field,
                      const Motion& motion, bool slow) {
  loop = {};
  loop.body = &body;
  loop.budget = budget;
  loop.nodes = nodes;
  loop.field = field;
  loop.motion = motion;
  loop.steps_per_cycle = slow ? 10 : 1;
  loop.timing.refined = timed_cycles;
  cycle = 0;
  if (motion.factor_at_hand) {
    move_contacts();
    loop.body->step(loop.contact, {~std::uint64_t{0}}, {as_vec3(loop.force), {}});
  }
  start_periodic_interrupt(period);
  while (cycle < timed_cycles) {
    asm volatile("wfi");
  }
  stop_periodic_interrupt();
  std::sort(loop.instructions.begin(), loop.instructions.end());
  loop.timing.cycles = timed_cycles;
  loop.timing.waiting = static_cast<std::uint32_t>(loop.counts.waiting);
  loop.timing.held = static_cast<std::uint32_t>(loop.counts.refusals());
  loop.timing.worst_work = loop.counts.worst_work;
  loop.timing.median = loop.instructions[timed_cycles / 2];
  loop.timing.worst = loop.instructions.back();
  return loop.timing;
}

}  // namespace greenloop::firmware
