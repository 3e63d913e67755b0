#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "sim_hw/session/drag_session.hpp"
#include "sim_hw/session/interruption.hpp"
#include "sim_hw/session/loaded_model.hpp"
#include "sim_hw/session/motion_session.hpp"
#include "sim_hw/session/session.hpp"
#include "sim_hw/session/stability.hpp"
#include "sim_hw/session/verdict.hpp"

namespace {

struct Outputs {
  std::string script;  // as it was named
  std::string trace, snapshot, stability;
  std::size_t stability_steps = 8;
  bool json = false, judge_time = false;
};

/// "N:CYCLES" of --inject-delay.
void read_delay(const std::string& text, greenloop::InjectedFaults& faults) {
  std::size_t read = 0;
  try {
    faults.delay_from = std::stoll(text, &read);
    if (text.at(read) != ':') throw std::invalid_argument(text);
    const std::string cycles = text.substr(read + 1);
    faults.delay_cycles = std::stoll(cycles, &read);
    if (read != cycles.size() || faults.delay_from < 0 || faults.delay_cycles < 1) throw std::invalid_argument(text);
  } catch (const std::exception&) {
    throw CLI::ValidationError("--inject-delay", "'" + text + "' is not N:CYCLES, as in 100:5");
  }
}

template <std::size_t count>
std::size_t place_of(const std::string& name, const std::string_view (&names)[count]) {
  return static_cast<std::size_t>(std::find(std::begin(names), std::end(names), name) - std::begin(names));
}

template <std::size_t count>
std::vector<std::string> all_of(const std::string_view (&names)[count]) {
  return {std::begin(names), std::end(names)};
}

greenloop::Transport read_transport(const std::string& name) {
  using greenloop::Transport;
  return name == "udpm" ? Transport::udpm : name == "memq" ? Transport::memq : Transport::automatic;
}

// scripts of one kind of model alone
constexpr const char* impulses = "impulses";
constexpr const char* drag = "drag";

std::vector<std::string> script_choices() {
  std::vector<std::string> names = all_of(greenloop::script_names);
  names.emplace_back(impulses);
  names.emplace_back(drag);
  return names;
}

void declare_run(CLI::App& app, greenloop::SessionOptions& options, std::string& script) {
  app.add_option("--seconds", options.seconds, "Virtual time of the run")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 3600.0));
  app.add_option("--rate", options.rate, "Cycles per second (default: the model's)")
      ->check(CLI::Range(greenloop::least_rate, greenloop::most_rate));
  app.add_option("--share", options.share, "Of a period that a cycle may take (default: the model's, or all of it)")
      ->check(CLI::Range(0.001, 1.0));
  app.add_option_function<std::string>(
         "--script",
         [&options, &script](const std::string& name) {
           script = name;
           if (name != impulses && name != drag) {
             options.script = static_cast<greenloop::Script>(place_of(name, greenloop::script_names));
           }
         },
         "What the hands do (default: all); impulses, for a model of motions; drag, for a multigrid model")
      ->check(CLI::IsMember(script_choices()));
  app.add_option("--motions", options.motions,
                 "A model of motions of the same surface, .gloop: the body vibrates while it is touched");
  app.add_option("--friction", options.friction, "Coulomb's coefficient between tools and body")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10.0));
  app.add_option("--tools", options.tools, "Hands at most; each beyond the second presses a place of its own")
      ->capture_default_str()
      ->check(CLI::Range(1U, greenloop::max_tools));
  app.add_option("--budget", options.budget, "Work units per cycle (default: the model's)")->check(CLI::PositiveNumber);
  app.add_option("--starve", options.starve, "Multiplies the budget")
      ->capture_default_str()
      ->check(CLI::Range(1e-9, 1.0));
  app.add_option_function<std::string>(
         "--passive",
         [&options](const std::string& name) {
           options.passive = static_cast<greenloop::Passive>(place_of(name, greenloop::passive_names));
         },
         "tank: what would make energy is braked; coupling: a spring between hands and tools; none (default)")
      ->check(CLI::IsMember(all_of(greenloop::passive_names)));
  app.add_option_function<std::string>(
         "--hand",
         [&options](const std::string& name) {
           options.hand = static_cast<greenloop::Holder>(place_of(name, greenloop::holder_names));
         },
         "Who holds the handles (default: person)")
      ->check(CLI::IsMember(all_of(greenloop::holder_names)));
  app.add_option("--gain", options.gain, "Of the force on the handles")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e3));
  app.add_option("--delay", options.delay, "Cycles from a state to the rendering of its command, beyond its own")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  app.add_option("--fast-rate", options.fast_rate,
                 "Of a loop that evaluates the body's local model between steps, a multiple of the rate (Hz)")
      ->check(CLI::Range(greenloop::least_rate, greenloop::most_rate));
  app.add_option_function<std::string>(
         "--transport", [&options](const std::string& name) { options.transport = read_transport(name); },
         "udpm: two processes in a network namespace; memq: one; auto (default): udpm where permitted")
      ->check(CLI::IsMember({"auto", "udpm", "memq"}));
  app.add_option("--field", options.field_every,
                 "The displacement of the whole body every N cycles (default: 1, of motions and multigrid models 60 "
                 "times a second)")
      ->check(CLI::PositiveNumber);
}

void declare_faults(CLI::App& app, greenloop::SessionOptions& options) {
  app.add_option_function<std::string>(
         "--inject-delay", [&options](const std::string& text) { read_delay(text, options.faults); },
         "From cycle N on the link holds commands back for so many cycles of virtual time")
      ->type_name("N:CYCLES");
  app.add_option("--inject-loss", options.faults.loss_every, "The link loses every K-th command")
      ->check(CLI::PositiveNumber);
  app.add_option("--inject-overrun", options.overrun_cycle, "Negative control: this cycle overspends its budget")
      ->check(CLI::NonNegativeNumber);
}

void declare(CLI::App& app, greenloop::SessionOptions& options, Outputs& outputs) {
  app.add_option("model", options.model, "The model file, .gloop")->required();
  declare_run(app, options, outputs.script);
  declare_faults(app, options);
  app.add_option("--trace", outputs.trace, "Writes one line per cycle to this CSV file");
  app.add_option("--snapshot", outputs.snapshot, "Writes the field of the largest force to this CSV file");
  app.add_option(
      "--stability", outputs.stability,
      "Runs no script: writes to this CSV file at which rates, delays and stiffnesses a pressed ball comes to "
      "rest, and the analytic bound");
  app.add_option("--stability-steps", outputs.stability_steps, "Stiffnesses for each rate and delay")
      ->capture_default_str()
      ->check(CLI::Range(2, 100));
  app.add_flag("--judge-time", outputs.judge_time,
               "Fail if a cycle takes longer than its share of the period, or if this machine cannot tell: it takes a "
               "program that is pinned to one isolated processor");
  app.add_flag("--json", outputs.json, "Prints the verdict as JSON");
}

void require_outputs(const greenloop::SessionOptions& options, const Outputs& outputs) {
  greenloop::CommandFiles files{.inputs = {{"the model", options.model}}, .outputs = {}};
  if (!options.motions.empty()) files.inputs.push_back({"the motions", options.motions});
  if (!outputs.trace.empty()) files.outputs.push_back({"the trace", outputs.trace});
  if (!outputs.stability.empty()) files.outputs.push_back({"the stability map", outputs.stability});
  if (!outputs.snapshot.empty()) files.outputs.push_back({"the snapshot", outputs.snapshot});
  greenloop::require_writable(files);
}

int map_stability(const greenloop::SessionOptions& options, const Outputs& outputs) {
  const auto cells = greenloop::stability_map(options, outputs.stability_steps);
  greenloop::write_stability(outputs.stability, cells);
  std::size_t below = 0, above = 0, stable_below = 0, stable_above = 0;
  for (const greenloop::StabilityCell& cell : cells) {
    const bool passive = cell.stiffness <= cell.bound;
    ++(passive ? below : above);
    if (cell.stable()) ++(passive ? stable_below : stable_above);
  }
  if (outputs.json) {
    const nlohmann::ordered_json json{{"stability", outputs.stability}, {"cells", cells.size()},
                                      {"within_bound", below},          {"stable_within_bound", stable_below},
                                      {"beyond_bound", above},          {"stable_beyond_bound", stable_above}};
    greenloop::print_result(greenloop::json_text(json) + "\n");
  } else {
    greenloop::print_result(outputs.stability + ": of " + std::to_string(below) + " loops within the bound " +
                            std::to_string(stable_below) + " come to rest, of " + std::to_string(above) +
                            " beyond it " + std::to_string(stable_above) + "\n");
  }
  return stable_below == below ? 0 : 1;
}

// the verdict of a run
template <class Result, class Verdict>
int hand_out(const greenloop::SessionOptions& options, const Result& result, const Verdict& verdict, bool as_json) {
  if (as_json) {
    greenloop::print_result(greenloop::json_text(greenloop::to_json(options, result, verdict)) + "\n");
  } else {
    greenloop::print_result(greenloop::to_text(options, result, verdict));
  }
  if (result.interruption != 0) return 128 + result.interruption;
  return verdict.passed() ? 0 : 1;
}

// throws std::runtime_error for another script than the one there is, and for options that go with contacts
void require_own_options(const CLI::App& app, const greenloop::SessionOptions& options, const Outputs& outputs,
                         const std::string& model, const std::string& script, std::vector<const char*> other_options) {
  if (!outputs.script.empty() && outputs.script != script) {
    throw std::runtime_error(options.model.string() + ": --script " + outputs.script + ": " + model + " has " + script +
                             " alone");
  }
  for (const char* const option : {"--motions", "--friction", "--tools", "--passive", "--hand", "--gain", "--delay",
                                   "--fast-rate", "--stability"}) {
    other_options.push_back(option);
  }
  for (const char* const option : other_options) {
    if (app.get_option(option)->count() > 0) {
      throw std::runtime_error(options.model.string() + ": " + option + ": not for " + model);
    }
  }
}

int run_motions(const greenloop::SessionOptions& options, const Outputs& outputs) {
  greenloop::await_interruption();
  const greenloop::MotionResult result = greenloop::run_motion_session(options);
  const greenloop::MotionVerdict verdict = greenloop::judge(result, outputs.judge_time);
  if (!outputs.trace.empty()) result.log.write_trace(outputs.trace, 1 / result.rate, result.budget.work);
  return hand_out(options, result, verdict, outputs.json);
}

int run_drag(const greenloop::SessionOptions& options, const Outputs& outputs) {
  if (outputs.script.empty()) {
    throw std::runtime_error(options.model.string() + ": a multigrid model has the script drag: give --script drag");
  }
  greenloop::await_interruption();
  const greenloop::DragResult result = greenloop::run_drag_session(options);
  const greenloop::DragVerdict verdict = greenloop::judge(result, outputs.judge_time);
  if (!outputs.trace.empty()) result.log.write_trace(outputs.trace, 1 / result.rate, result.budget.work);
  if (!outputs.snapshot.empty()) result.log.write_snapshot(outputs.snapshot);
  return hand_out(options, result, verdict, outputs.json);
}

int run(const CLI::App& app, greenloop::SessionOptions options, const Outputs& outputs) {
  require_outputs(options, outputs);
  options.keep_records = !outputs.trace.empty();
  const greenloop::layout::Problem problem = greenloop::problem_of(options.model);
  if (problem == greenloop::layout::Problem::impulse_response) {
    require_own_options(app, options, outputs, "a model of motions", impulses, {"--snapshot"});
    return run_motions(options, outputs);
  }
  if (problem == greenloop::layout::Problem::multigrid) {
    require_own_options(app, options, outputs, "a multigrid model", drag, {"--rate"});
    return run_drag(options, outputs);
  }
  for (const char* const script : {impulses, drag}) {
    if (outputs.script != script) continue;
    throw std::runtime_error(options.model.string() + ": --script " + script + ": this is no " +
                             (script == drag ? "multigrid model" : "model of motions"));
  }
  if (!outputs.stability.empty() && !options.motions.empty()) {
    throw std::runtime_error("--stability: it maps a body that stands still; leave --motions out");
  }
  if (!outputs.stability.empty()) return map_stability(options, outputs);
  greenloop::await_interruption();
  const greenloop::SessionResult result = greenloop::run_session(options);
  const greenloop::Verdict verdict = greenloop::judge(result, outputs.judge_time);
  if (!outputs.trace.empty()) {
    const std::uint32_t columns = std::max(result.tools, 2U);  // a second probe that is not there reads zero
    result.log.write_trace(outputs.trace, columns, result.device_period);
  }
  if (!outputs.snapshot.empty()) result.log.write_snapshot(outputs.snapshot);
  return hand_out(options, result, verdict, outputs.json);
}

}  // namespace

/// Exit status 0: every cycle held its budget, and its share of the period where that is judged. 1: it did not, or the
/// run could not start. 2: wrong usage. 128 + n: signal n ended the run, with the trace and the verdict of its cycles
/// until then.
int main(int argc, char** argv) {
  CLI::App app{"Drives a control loop on a Greenloop model with a simulated device, in virtual time.",
               "greenloop-loop"};
  greenloop::SessionOptions options;
  Outputs outputs;
  declare(app, options, outputs);
  return greenloop::run_program(app, argc, argv, [&] { return run(app, options, outputs); });
}
