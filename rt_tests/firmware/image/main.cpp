// What the host's command line asks for: "--script" runs the recorded script on models of lifted Linear and of
// Equilibrated wavelets and compares the digests, "--loop" runs a hand of eight contacts in a 1 kHz interrupt and
// compares the instructions of a step with the bar, "--ready" holds eight contacts on a larger model that is read in
// place. "--steps" prints the instructions of every step of the recorded script with counting_prices on each model,
// what greenloop-calibrate fits this processor's prices to; "--priced" compares work at these prices with instructions,
// with "--more" of three scripts a model. "--impulses" plays motions. "--tools" touches with a ball; "--law-steps" and
// "--laws" are "--steps" and
// "--priced" of the laws of contact. "--flip-bit" and "--slow" are their negative
// controls. Exit status: 0, or which check failed.
#include <algorithm>

#include "body_model.h"
#include "ready_body_model.h"
#include "recorded_butterfly.h"
#include "recorded_equilibrated.h"
#include "recorded_model.h"
#include "recorded_motion.h"
#include "rt_tests/firmware/image/counted_script.hpp"
#include "rt_tests/firmware/image/image_driver.hpp"
#include "rt_tests/firmware/image/instruction_clock.hpp"
#include "rt_tests/firmware/image/laws.hpp"
#include "rt_tests/firmware/image/moving.hpp"
#include "rt_tests/firmware/image/semihosting.hpp"
#include "rt_tests/firmware/image/stack.hpp"
#include "rt_tests/firmware/image/timed_loop.hpp"
#include "rt_tests/firmware/image/touching.hpp"
#include "rt_tests/harness/impulse_run.hpp"
#include "rt_tests/harness/price_table.hpp"
#include "rt_tests/harness/recorded_run.hpp"
#include "runtime/testing/touchable_nodes.hpp"
#include "shown_motion.h"

extern "C" const std::byte flash_used[], ram_used[];  // their addresses are the numbers of bytes

namespace greenloop::firmware {
namespace {

enum ExitStatus : int { passed, clock_is_wrong, does_not_run, not_a_check, digest_differs, over_the_bar };

constexpr std::uint32_t bar = 100'000;            // instructions: a quarter of 1 ms at 400 MHz, one instruction a cycle
constexpr std::uint64_t usual_budget = 109'000;   // units, measured to stay below the bar whatever is touched
constexpr std::uint64_t refining_work = 105'000;  // the same
constexpr std::uint32_t most_steps_to_the_finest = 40;

// of the ready body: the field of more nodes takes longer, all of them three times the bar
constexpr std::uint32_t most_displaced_within_the_bar = 42;

constexpr std::size_t most_nodes = 700;
alignas(64) std::byte arena[144 * 1024];
alignas(16) float field[4 * most_nodes];
Solver::Requirement requirement;
RecordedRun recorded;

struct Neighbour {
  float square_distance;
  std::uint32_t node;
};
Neighbour neighbour[most_nodes];
std::uint32_t nodes[most_nodes];

void print_line(const char* name, std::uint64_t number) {
  print(name);
  print(" ");
  print(number);
  print("\n");
}

// three instructions for every turn
bool clock_is_right() {
  constexpr std::uint32_t turns = 100'000;
  const std::uint64_t begin = instructions();
  std::uint32_t left = turns;
  asm volatile("1: nop\n subs %0, #1\n bne 1b" : "+l"(left)::"cc");
  const std::uint64_t counted = instructions() - begin;
  print_line("instructions counted in a loop of 300000", counted);
  return counted >= 3 * turns && counted <= 3 * turns + 2 * instructions_per_tick;
}

void print_sizes() {
  print_line("flash bytes, all models included", reinterpret_cast<std::uintptr_t>(flash_used));
  print_line("RAM bytes, stack and arena included", reinterpret_cast<std::uintptr_t>(ram_used));
  print_line("deepest stack bytes", deepest_stack());
}

int run_script(std::span<const std::byte> model, std::uint64_t digest, bool flip) {
  recorded = run_recorded_script<ImageDriver>(model, arena, field, flip);
  print_line("arena bytes", recorded.arena_bytes);
  if (recorded.error != nullptr) {
    print(recorded.error);
    return does_not_run;
  }
  print_line("work units", recorded.counts.work);
  print("digest ");
  print_hexadecimal(recorded.digest);
  print("\n");
  return recorded.digest == digest ? passed : digest_differs;
}

// a bit is flipped on the last model
int run_scripts(bool flip) {
  const int first = run_script(std::as_bytes(std::span(recorded_model)), recorded_digest, false);
  const int last = run_script(std::as_bytes(std::span(recorded_equilibrated)), recorded_equilibrated_digest, flip);
  return first == passed ? last : first;
}

// touchable nodes by their distance from the first of them
std::span<const std::uint32_t> list_nodes(const ModelView& view) {
  std::uint32_t count = 0;
  const float* centre = nullptr;
  visit_touchable(view, [&](std::uint32_t node, const layout::NodeRecord& record) {
    if (count == most_nodes) {
      return;
    }
    centre = centre == nullptr ? record.position : centre;
    float sum = 0;
    for (int r = 0; r < 3; ++r) {
      sum += (record.position[r] - centre[r]) * (record.position[r] - centre[r]);
    }
    neighbour[count++] = {sum, node};
  });
  std::sort(neighbour, neighbour + count,
            [](const Neighbour& a, const Neighbour& b) { return a.square_distance < b.square_distance; });
  std::transform(neighbour, neighbour + count, nodes, [](const Neighbour& at) { return at.node; });
  return {nodes, count};
}

void print_line(const Motion& motion, const Timing& timing) {
  print(motion.name);
  print(": instructions of a step, median ");
  print(timing.median);
  print(", worst ");
  print(timing.worst);
  print("; most work ");
  print(timing.worst_work);
  print("; finest level ");
  print(timing.finest);
  print(" from step ");
  print(timing.refined);
  print(" on, waiting ");
  print(timing.waiting);
  print(", not answered ");
  print(timing.held);
  print(", late ");
  print(timing.late);
  print(" of ");
  print(timing.cycles);
  print("\n");
}

int run_loop(bool slow) {
  constexpr Motion motions[] = {{"pressed", 0, false},
                                {"a node in 16 ms", 16, false},
                                {"a node in every step", 1, false},
                                {"pressed at the finest level", 0, true}};
  constexpr Solver::Limits limits{.max_contacts = contacts_per_step,
                                  .cached_factors = 2,
                                  .refining_work = refining_work,
                                  .prices = cortex_m7_prices()};
  const auto opened = Model::open(std::as_bytes(std::span(body_model)));
  if (!opened || opened.model.node_count() > most_nodes) {
    return does_not_run;
  }
  requirement = Solver::required(opened.model, limits);
  print_line("nodes", opened.model.node_count());
  print_line("arena bytes", requirement.bytes);
  print_line("least work", requirement.least_work);
  // the least that is declared bounds any contacts: more than these take
  const Budget budget{std::max(usual_budget, requirement.least_work)};
  print_line("budget", budget.work);
  auto created = Solver::create(opened.model, limits, arena);
  if (!created) {
    return does_not_run;
  }
  const std::span<float> displacement(field, std::size_t{4} * opened.model.node_count());
  int status = passed;
  for (const Motion& motion : motions) {
    const Timing timing =
        run_timed_loop(created.body, budget, list_nodes(opened.model.view()), displacement, motion, slow);
    print_line(motion, timing);
    const bool stays = motion.cycles_per_node == 0;
    const bool refined = timing.refined <= (motion.factor_at_hand ? 0 : most_steps_to_the_finest) &&
                         timing.finest == timing.cycles - timing.refined;
    const bool met = timing.worst <= bar && timing.held == 0 && timing.late == 0 && (!stays || refined);
    status = met ? status : over_the_bar;
  }
  return status;
}

// steps of the ready body with a cached factor, at the finest level: with the field of all nodes, of those of the
// coarser levels, and without
int run_ready(bool slow) {
  constexpr Solver::Limits limits{.max_contacts = contacts_per_step, .cached_factors = 4, .prices = cortex_m7_prices()};
  std::uint64_t begin = instructions();
  const auto opened = Model::open(std::as_bytes(std::span(ready_body_model)));
  print_line("instructions to open it", instructions() - begin);
  if (!opened || opened.model.node_count() > most_nodes) {
    return does_not_run;
  }
  begin = instructions();
  requirement = Solver::required(opened.model, limits);
  print_line("instructions to declare its bytes and work", instructions() - begin);
  print_line("nodes", opened.model.node_count());
  print_line("model bytes", ready_body_model_size);
  print_line("arena bytes", requirement.bytes);
  begin = instructions();
  auto created = Solver::create(opened.model, limits, arena);
  print_line("instructions to create it", instructions() - begin);
  if (!created) {
    return does_not_run;
  }
  constexpr Budget any{~std::uint64_t{0}};
  constexpr Motion pressed{"pressed at the finest level", 0, true};
  int status = passed;
  for (std::uint32_t levels = opened.model.level_count() + 1; levels-- > 0;) {
    const std::uint32_t displaced = levels == 0 ? 0 : opened.model.node_count(levels - 1);
    print_line("nodes whose displacement is asked for", displaced);
    const Timing timing = run_timed_loop(created.body, any, list_nodes(opened.model.view()),
                                         std::span(field).first(std::size_t{4} * displaced), pressed, slow);
    print_line(pressed, timing);
    const bool answered = timing.finest == timing.cycles && timing.held == 0 && timing.late == 0;
    const bool met = answered && (timing.worst <= bar || displaced > most_displaced_within_the_bar);
    status = met ? status : over_the_bar;
  }
  return status;
}

// models of all kinds of wavelets
constexpr std::span<const std::uint8_t> counted_models[] = {recorded_model, recorded_butterfly, recorded_equilibrated,
                                                            body_model, ready_body_model};

int print_steps() {
  for (const auto model : counted_models) {
    const CountedScript script{std::as_bytes(model), counting_prices(), 20, arena, field};
    const bool ran = script.run([](const Solver::StepReport&, std::uint64_t counted) {
      print(std::max<std::uint64_t>(counted, 1));
      print("\n");
    });
    if (!ran) {
      return does_not_run;
    }
  }
  return passed;
}

// scripts of so many seeds
int compare_priced(std::uint64_t seeds) {
  int status = passed;
  for (const auto model : counted_models) {
    PredictedInstructions predicted;
    bool ran = true;
    for (std::uint64_t seed = 21; ran && seed < 21 + seeds; ++seed) {
      const CountedScript script{std::as_bytes(model), cortex_m7_prices(), seed, arena, field};
      ran = script.run([&](const Solver::StepReport& report, std::uint64_t counted) {
        if (answered(report.status)) {
          predicted.add(report.work, counted);
        }
      });
    }
    predicted.print();
    status = !ran ? does_not_run : predicted.meets_the_bar() ? status : over_the_bar;
  }
  return status;
}

constexpr std::uint32_t Prices::*law_prices[] = {&Prices::law,           &Prices::law_block,  &Prices::swept_law,
                                                 &Prices::projected_law, &Prices::frozen_law, &Prices::law_vector};

// how often a solution of the laws of contact does what each of these is the price of, and its instructions
int print_laws() {
  LawProblems problem(1);
  for (std::uint32_t i = 0; i < LawProblems::problems; ++i) {
    problem.next();
    const auto solved = problem.solve({}, arena);
    if (!solved.valid) {
      return does_not_run;
    }
    for (const auto price : law_prices) {
      Prices dearer;
      dearer.*price += 256;
      print(problem.solve(dearer, arena).work - solved.work);
      print(" ");
    }
    print(solved.instructions);
    print("\n");
  }
  return passed;
}

int compare_laws() {
  PredictedInstructions predicted;
  LawProblems problem(2);
  for (std::uint32_t i = 0; i < LawProblems::problems; ++i) {
    problem.next();
    const auto solved = problem.solve(cortex_m7_prices(), arena);
    if (!solved.valid) {
      return does_not_run;
    }
    predicted.add(solved.work, solved.instructions);
  }
  predicted.print();
  return predicted.meets_the_bar() ? passed : over_the_bar;
}

constexpr std::uint32_t bar_of_frames = 6'600'000;  // a period of 60 Hz at 400 MHz

// the recorded motions' digest, then what steps of larger ones take, whose displacements are 60 frames a second
int run_impulses(bool flip, bool slow) {
  const auto opened = Model::open(std::as_bytes(std::span(recorded_motion)));
  if (!opened) {
    return does_not_run;
  }
  constexpr std::size_t modes = 8, vertices = 91;
  const std::span<float> all(field);
  const std::span<float> moved = all.subspan(2 * modes, 3 * vertices);
  const ImpulseRun run = run_impulse_script(opened.model, {}, arena,
                                            {all.first(modes), all.subspan(modes, modes), as_vec3(moved),
                                             as_vec3(all.subspan(2 * modes + 3 * vertices, 3 * vertices)),
                                             as_vec3(all.subspan(2 * modes + 6 * vertices, 3 * vertices))},
                                            impulse_cycles, 1, flip);
  print("digest of impulses ");
  print_hexadecimal(run.digest);
  print("\n");
  if (run.error != nullptr) {
    print(run.error);
    return does_not_run;
  }
  if (run.digest != impulse_digest) {
    return digest_differs;
  }
  const MovingTiming timing = time_moving(std::as_bytes(std::span(shown_motion)), arena, field, slow);
  print_line("modes", timing.modes);
  print_line("vertices", timing.vertices);
  print_line("model bytes", shown_motion_size);
  print_line("instructions of a step without displacements, worst", timing.state_worst);
  print_line("units declared for it", timing.state_work);
  print_line("instructions with all displacements, worst", timing.frame_worst);
  print_line("units declared for them", timing.frame_work);
  if (!timing.ran) {
    return does_not_run;
  }
  return timing.state_worst <= bar && timing.frame_worst <= bar_of_frames ? passed : over_the_bar;
}

constexpr std::uint32_t bar_of_tools = 200'000;  // half of 1 ms at 400 MHz

int run_tools(bool slow) {
  const TouchingTiming timing = time_touching(std::as_bytes(std::span(body_model)), arena, slow);
  print_line("arena bytes", timing.arena_bytes);
  print_line("least work", timing.least_work);
  print_line("most work", timing.most_work);
  print_line("steps in which the ball touches", timing.touching);
  print_line("of these at the finest level", timing.finest);
  print_line("places that may touch, at most", timing.most_contacts);
  print_line("largest force, mN", static_cast<std::uint64_t>(1000 * timing.most_force));
  print_line("laws of contact within, millionths", static_cast<std::uint64_t>(1e6F * timing.most_residual));
  print_line("instructions of such a step, median", timing.median);
  print_line("worst", timing.worst);
  return !timing.ran ? does_not_run : timing.worst <= bar_of_tools ? passed : over_the_bar;
}

}  // namespace
}  // namespace greenloop::firmware

int main() {
  using namespace greenloop::firmware;
  start_instruction_clock();
  if (command_line_contains("--steps")) {
    return print_steps();
  }
  if (command_line_contains("--law-steps")) {
    return print_laws();
  }
  if (!clock_is_right()) {
    return clock_is_wrong;
  }
  int status = not_a_check;
  if (command_line_contains("--script")) {
    status = run_scripts(command_line_contains("--flip-bit"));
  } else if (command_line_contains("--loop")) {
    status = run_loop(command_line_contains("--slow"));
  } else if (command_line_contains("--ready")) {
    status = run_ready(command_line_contains("--slow"));
  } else if (command_line_contains("--priced")) {
    status = compare_priced(command_line_contains("--more") ? 3 : 1);
  } else if (command_line_contains("--laws")) {
    status = compare_laws();
  } else if (command_line_contains("--impulses")) {
    status = run_impulses(command_line_contains("--flip-bit"), command_line_contains("--slow"));
  } else if (command_line_contains("--tools")) {
    status = run_tools(command_line_contains("--slow"));
  }
  print_sizes();
  return status;
}
