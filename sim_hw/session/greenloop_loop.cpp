#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "sim_hw/session/interruption.hpp"
#include "sim_hw/session/session.hpp"
#include "sim_hw/session/verdict.hpp"

namespace {

struct Outputs {
  std::string trace, snapshot;
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

greenloop::Script read_script(const std::string& name) {
  const auto* found = std::find(std::begin(greenloop::script_names), std::end(greenloop::script_names), name);
  return static_cast<greenloop::Script>(found - std::begin(greenloop::script_names));
}

greenloop::Transport read_transport(const std::string& name) {
  using greenloop::Transport;
  return name == "udpm" ? Transport::udpm : name == "memq" ? Transport::memq : Transport::automatic;
}

void declare_run(CLI::App& app, greenloop::SessionOptions& options) {
  app.add_option("--seconds", options.seconds, "Virtual time of the run")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 3600.0));
  app.add_option("--rate", options.rate, "Cycles per second (default: the model's)")
      ->check(CLI::Range(greenloop::least_rate, greenloop::most_rate));
  app.add_option("--share", options.share, "Of a period that a cycle may take (default: the model's, or all of it)")
      ->check(CLI::Range(0.001, 1.0));
  app.add_option_function<std::string>(
         "--script", [&options](const std::string& name) { options.script = read_script(name); },
         "What the hands do (default: all)")
      ->check(CLI::IsMember(
          std::vector<std::string>(std::begin(greenloop::script_names), std::end(greenloop::script_names))));
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
         "--transport", [&options](const std::string& name) { options.transport = read_transport(name); },
         "udpm: two processes in a network namespace; memq: one; auto (default): udpm where permitted")
      ->check(CLI::IsMember({"auto", "udpm", "memq"}));
  app.add_option("--field", options.field_every, "The displacement of the whole body every N cycles")
      ->capture_default_str()
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
  declare_run(app, options);
  declare_faults(app, options);
  app.add_option("--trace", outputs.trace, "Writes one line per cycle to this CSV file");
  app.add_option("--snapshot", outputs.snapshot, "Writes the field of the largest force to this CSV file");
  app.add_flag("--judge-time", outputs.judge_time,
               "Fail if a cycle takes longer than its share of the period, or if this machine cannot tell: it takes a "
               "program that is pinned to one isolated processor");
  app.add_flag("--json", outputs.json, "Prints the verdict as JSON");
}

void require_outputs(const greenloop::SessionOptions& options, const Outputs& outputs) {
  greenloop::CommandFiles files{.inputs = {{"the model", options.model}}, .outputs = {}};
  if (!outputs.trace.empty()) files.outputs.push_back({"the trace", outputs.trace});
  if (!outputs.snapshot.empty()) files.outputs.push_back({"the snapshot", outputs.snapshot});
  greenloop::require_writable(files);
}

int run(const greenloop::SessionOptions& options, const Outputs& outputs) {
  require_outputs(options, outputs);
  greenloop::await_interruption();
  const greenloop::SessionResult result = greenloop::run_session(options);
  const greenloop::Verdict verdict = greenloop::judge(result, outputs.judge_time);
  if (!outputs.trace.empty()) {
    const std::uint32_t columns = std::max(result.tools, 2U);  // a second probe that is not there reads zero
    result.log.write_trace(outputs.trace, columns, 1 / result.rate, result.budget);
  }
  if (!outputs.snapshot.empty()) result.log.write_snapshot(outputs.snapshot);
  if (outputs.json) {
    greenloop::print_result(greenloop::json_text(greenloop::to_json(options, result, verdict)) + "\n");
  } else {
    greenloop::print_result(greenloop::to_text(options, result, verdict));
  }
  if (result.interruption != 0) return 128 + result.interruption;
  return verdict.passed() ? 0 : 1;
}

}  // namespace

/// Exit status 0: every cycle held its budget, and its share of the period where that is judged. 1: it did not, or the
/// run could not start. 2: wrong usage. 128 + n: signal n ended the run, with the trace and the verdict of its cycles
/// until then.
int main(int argc, char** argv) {
  CLI::App app{"Drives a control loop on a Greenloop model with a simulated haptic device, in virtual time.",
               "greenloop-loop"};
  greenloop::SessionOptions options;
  Outputs outputs;
  declare(app, options, outputs);
  return greenloop::run_program(app, argc, argv, [&] { return run(options, outputs); });
}
