#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "runtime/elastostatic.hpp"
#include "sim_hw/session/testing/program_run.hpp"

namespace greenloop {
namespace {

using Words = std::vector<std::string>;

/// A folder of this process with the synthetic model in it.
class Workspace {
 public:
  Workspace() : folder_(std::filesystem::temp_directory_path() / ("greenloop_loop_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    ModelData data = synthetic_model({.levels = 5, .touchable_above = -0.2});
    data.info.max_contacts = 16;
    data.info.step_work = 2600000;
    write_file(model(), encode(data));
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
  ~Workspace() { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::string model() const { return file("sphere.gloop"); }

 private:
  std::filesystem::path folder_;
};

const Workspace& workspace() {
  static const Workspace only;
  return only;
}

/// One second of the whole script.
ProgramRun run_text(const Words& more, bool deny_namespaces = false) {
  Words words{workspace().model(), "--seconds", "1"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(GREENLOOP_LOOP, words, deny_namespaces);
}

/// The same, its JSON read; the exit status must be `expected`.
nlohmann::json run_json(Words more, int expected = 0, bool deny_namespaces = false) {
  more.emplace_back("--json");
  const ProgramRun run = run_text(more, deny_namespaces);
  INFO(run.output << run.errors);
  REQUIRE(run.exit_status == expected);
  return nlohmann::json::parse(run.output);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::int64_t cycles_below(const nlohmann::json& json, std::uint32_t finest) {
  std::int64_t cycles = 0;
  for (const auto& used : json["levels_used"]) {
    if (used["level"] < finest) cycles += used["cycles"].get<std::int64_t>();
  }
  return cycles;
}

TEST_CASE("a model whose scene's work is the least that its body needs runs with tools, too") {
  ModelData data = synthetic_model({.levels = 2, .touchable_above = 0.9});
  data.info.max_contacts = 1;
  const auto bytes = encode(data);
  const Model model = Model::open(bytes).model;
  data.info.step_work = Elastostatic::required(model, Elastostatic::intended(model).limits).least_work;
  const std::string file = workspace().file("least.gloop");
  write_file(file, encode(data));
  const ProgramRun run = run_program(GREENLOOP_LOOP, {file, "--seconds", "1", "--transport", "memq", "--json"}, false);
  INFO(run.output << run.errors);
  REQUIRE(run.exit_status == 0);
  CHECK(nlohmann::json::parse(run.output)["misses"] == 0);
}

TEST_CASE("short of work forces are no larger than they should be") {
  const double right = run_json({"--transport", "memq"})["force_max"];
  for (const char* budget : {"1000000", "1200000", "1800000"}) {
    const double starved = run_json({"--transport", "memq", "--budget", budget})["force_max"];
    CHECK(starved < 1.05 * right);
    CHECK(starved > 0.5 * right);
  }
}

TEST_CASE("in one process every cycle holds its budget, and every run has the same digest") {
  const auto json = run_json({"--transport", "memq"});
  CHECK(json["cycles"] == 1000);
  CHECK(json["misses"] == 0);
  CHECK(json["late"] == 0);
  CHECK(json["allocations"] == 0);
  CHECK(json["budget_work"] > 2600000);  // the scene's, and what finding contacts may take
  CHECK(json["budget_work"] < 3600000);
  CHECK(json["worst_work"] <= json["budget_work"]);
  CHECK(json["worst_work"] > 0);
  CHECK(json["contacts_max"] >= 3);
  CHECK(json["force_max"] > 1.0);
  CHECK(json["contact_cycles"] > 200);
  CHECK(json["tools"].size() == 2);
  CHECK(json["tools"][0]["contacts"].get<int>() + json["tools"][1]["contacts"].get<int>() > 0);
  CHECK(json["energy"]["in"] > 0);
  CHECK(json["energy"]["dissipated"] >= 0);
  CHECK(json["energy"]["generated"] <= 0.02 * json["energy"]["in"].get<double>());
  CHECK(json["residual_max"] <= 1e-3);
  CHECK(json["force_step_max"] <= 0.3 * json["force_max"].get<double>());
  CHECK(json["fall_throughs"] == 0);
  CHECK(json["processes"] == 1);
  CHECK(json["transport"] == "memq");
  CHECK(json["reason"] == "asked for");
  CHECK(json["script"] == "all");
  CHECK(json["seconds"] == 1.0);
  CHECK(json["step_us"]["median"] <= json["step_us"]["p99"]);
  CHECK(json["step_us"]["p99"] <= json["step_us"]["max"]);
  CHECK(json["digest"].get<std::string>().size() == 16);
  CHECK(run_json({"--transport", "memq"})["digest"] == json["digest"]);
  CHECK(run_json({"--transport", "memq", "--script", "press"})["digest"] != json["digest"]);
}

TEST_CASE("two processes in a network namespace compute what one does") {
  const auto here = run_json({"--transport", "memq"});
  const auto json = run_json({});
  CHECK(json["digest"] == here["digest"]);
  CHECK(json["cycles"] == 1000);
  CHECK(json["misses"] == 0);
  if (json["transport"] == "udpm") {
    CHECK(json["processes"] == 2);
    CHECK_FALSE(json.contains("reason"));
  } else {
    MESSAGE("network namespaces are not permitted here: " << json["reason"]);
    CHECK(json["processes"] == 1);
    CHECK_FALSE(json["reason"].get<std::string>().empty());
  }
}

TEST_CASE("where namespaces are refused, auto says so and runs in one process, and udpm is an error") {
  const auto json = run_json({}, 0, true);
  CHECK(json["transport"] == "memq");
  CHECK(json["processes"] == 1);
  CHECK(contains(json["reason"], "namespace"));
  CHECK(json["digest"] == run_json({"--transport", "memq"})["digest"]);
  const ProgramRun refused = run_text({"--transport", "udpm"}, true);
  CHECK(refused.exit_status == 1);
  CHECK(contains(refused.errors, "namespace"));
}

/// The budget that a refusal names as the least.
std::uint64_t least_budget() {
  const ProgramRun refused = run_text({"--budget", "100"});
  CHECK(refused.exit_status == 1);
  CHECK(refused.output.empty());
  const std::string before = "the least budget of this model is ";
  const std::size_t at = refused.errors.find(before);
  REQUIRE(at != std::string::npos);
  return std::stoull(refused.errors.substr(at + before.size()));
}

TEST_CASE("starved, it keeps the finest level of contacts, answers another field, and misses nothing") {
  const auto fed = run_json({"--transport", "memq", "--budget", "4000000"});
  const std::uint64_t least = least_budget();
  const auto starved = run_json({"--transport", "memq", "--budget", std::to_string(2 * least), "--starve", "0.5"});
  CHECK(cycles_below(fed, 4) == 0);
  CHECK(cycles_below(starved, 4) == 0);
  CHECK(starved["misses"] == 0);
  CHECK(starved["budget_work"] == least);
  CHECK(starved["worst_work"] <= least);
  CHECK(starved["digest"] != fed["digest"]);
}

TEST_CASE("a budget below the coarsest answer is refused with the least one, which then holds") {
  const std::string least = std::to_string(least_budget());
  const auto json = run_json({"--transport", "memq", "--budget", least});
  CHECK(json["misses"] == 0);
  CHECK(json["worst_work"] <= json["least_work"]);
}

TEST_CASE("a cycle that overspends is a miss and fails the run") {
  const auto json = run_json({"--transport", "memq", "--inject-overrun", "500"}, 1);
  CHECK(json["misses"] == 1);
  CHECK(json["late"] == 1);
  CHECK(json["late_injected"] == 0);
  CHECK(json["worst_work"] > json["budget_work"]);
  CHECK(json["passed"] == false);
}

TEST_CASE("injected delays and losses are late in exactly as many cycles, and are no misses") {
  const auto delayed = run_json({"--transport", "memq", "--inject-delay", "300:7"});
  CHECK(delayed["late"] == 7);
  CHECK(delayed["misses"] == 0);
  const auto lossy = run_json({"--transport", "memq", "--inject-loss", "7"});
  CHECK(lossy["late"] == 142);
  CHECK(lossy["misses"] == 0);
  const auto both = run_json({"--inject-loss", "10", "--inject-delay", "300:15"});
  CHECK(both["late"] == 100 + 15 - 1);  // cycle 309 is both
  CHECK(both["digest"] != delayed["digest"]);
}

TEST_CASE("twenty late commands in a row stop the run, which has then failed") {
  for (const char* transport : {"memq", "auto"}) {
    const auto json = run_json({"--transport", transport, "--inject-delay", "300:400"}, 1);
    CHECK(json["stopped"] == true);
    CHECK(json["late"] == 20);
    CHECK(json["cycles"] == 320);
    CHECK(json["misses"] == 0);
  }
}

TEST_CASE("the trace has a line per cycle, the snapshot one per node") {
  const std::string trace = workspace().file("trace.csv"), snapshot = workspace().file("snapshot.csv");
  const auto json = run_json({"--transport", "memq", "--trace", trace, "--snapshot", snapshot});
  std::ifstream lines(trace);
  std::string line;
  std::getline(lines, line);
  CHECK(line ==
        "time,x0,y0,z0,x1,y1,z1,force_x0,force_y0,force_z0,force_x1,force_y1,force_z1,force,contacts,level,field_level,"
        "work,budget,status");
  std::size_t count = 0;
  double largest = 0;
  for (; std::getline(lines, line); ++count) {
    std::istringstream columns(line);
    std::vector<std::string> column;
    for (std::string text; std::getline(columns, text, ',');) column.push_back(text);
    REQUIRE(column.size() == 20);
    largest = std::max(largest, std::stod(column[13]));
  }
  CHECK(count == 1000);
  CHECK(largest == json["force_max"].get<double>());
  std::ifstream nodes(snapshot);
  double deepest = 0;
  for (count = 0, std::getline(nodes, line); std::getline(nodes, line); ++count) {
    deepest = std::min(deepest, std::stod(line.substr(line.rfind(',') + 1)));
  }
  CHECK(count == 1026);
  CHECK(deepest < 0);
}

TEST_CASE("more tools push more, with columns of their own in the trace") {
  const std::string trace = workspace().file("trace4.csv");
  const auto two = run_json({"--transport", "memq"});
  const auto four = run_json({"--tools", "4", "--trace", trace});
  CHECK(four["misses"] == 0);
  CHECK(four["contact_cycles"] > two["contact_cycles"]);
  CHECK(four["digest"] != two["digest"]);
  CHECK(run_json({"--transport", "memq", "--tools", "4"})["digest"] == four["digest"]);
  CHECK(run_json({"--transport", "memq", "--tools", "2"})["digest"] == two["digest"]);
  CHECK(run_json({"--transport", "memq", "--tools", "1"})["digest"] != two["digest"]);
  std::ifstream lines(trace);
  std::string line;
  std::getline(lines, line);
  CHECK(contains(line, ",x3,y3,z3,force_x0,"));
  CHECK(contains(line, ",force_x3,force_y3,force_z3,force,"));
  double largest = 0;
  while (std::getline(lines, line)) {
    std::istringstream columns(line);
    std::vector<std::string> column;
    for (std::string text; std::getline(columns, text, ',');) column.push_back(text);
    REQUIRE(column.size() == 32);
    for (std::size_t i = 22; i < 25; ++i) largest = std::max(largest, std::abs(std::stod(column[i])));  // force_x3...
  }
  CHECK(largest > 0);
  CHECK(run_text({"--tools", "0"}).exit_status == 2);
  CHECK(run_text({"--tools", "9"}).exit_status == 2);
}

TEST_CASE("every script touches, holds and lets nothing through; those that lose messages say so") {
  for (const char* script : {"pinch", "roll", "flap", "grasp", "slide", "lose-messages"}) {
    CAPTURE(script);
    const auto json = run_json({"--transport", "memq", "--script", script});
    CHECK(json["script"] == script);
    CHECK(json["misses"] == 0);
    CHECK(json["contact_cycles"] > 10);
    CHECK(json["fall_throughs"] == 0);
    CHECK((json["late_injected"] > 0) == (std::string(script) == "lose-messages"));
  }
  const ProgramRun dropped =
      run_program(GREENLOOP_LOOP, {workspace().model(), "--seconds", "5", "--script", "drop", "--json"});
  CHECK(dropped.exit_status == 0);
  CHECK(nlohmann::json::parse(dropped.output)["contact_cycles"] > 10);
  CHECK(nlohmann::json::parse(dropped.output)["fall_throughs"] == 0);
}

TEST_CASE("a model that knows gravity is tilted under a probe; one that does not is refused") {
  ModelData data = synthetic_model({.levels = 4, .touchable_above = -0.2, .gravity = true});
  data.info.max_contacts = 16;
  write_file(workspace().file("heavy.gloop"), encode(data));
  const ProgramRun tilted = run_program(
      GREENLOOP_LOOP, {workspace().file("heavy.gloop"), "--script", "tilt", "--transport", "memq", "--json"});
  INFO(tilted.output << tilted.errors);
  REQUIRE(tilted.exit_status == 0);
  const auto json = nlohmann::json::parse(tilted.output);
  CHECK(json["script"] == "tilt");
  CHECK(json["fall_throughs"] == 0);
  CHECK(json["contact_cycles"] > 1000);
  const ProgramRun no_gravity = run_text({"--script", "tilt"});
  CHECK(no_gravity.exit_status == 1);
  CHECK(contains(no_gravity.errors, "gravity = true"));
}

TEST_CASE("friction holds what slides, and without it nothing is dissipated") {
  const auto smooth = run_json({"--transport", "memq", "--script", "slide", "--friction", "0"});
  const auto rough = run_json({"--transport", "memq", "--script", "slide", "--friction", "0.5"});
  CHECK(smooth["energy"]["dissipated"] < 1e-6);
  CHECK(rough["energy"]["dissipated"] > 1e-4);
}

TEST_CASE("a tank and a coupling are felt where they are needed, in both transports alike") {
  const Words wild{"--transport", "memq", "--hand", "absent", "--gain", "40", "--delay", "4", "--script", "press"};
  const auto with = [&](const std::string& passive) {
    Words words = wild;
    words.insert(words.end(), {"--passive", passive});
    return run_json(words);
  };
  const auto none = with("none"), tank = with("tank"), coupling = with("coupling");
  CHECK(none["passive"] == "none");
  CHECK(none["hand"] == "absent");
  CHECK(none["delay"] == 4);
  CHECK(none["gain"] == 40.0);
  CHECK(none["energy"]["drained"] == 0.0);
  CHECK(none["energy"]["delivered_most"] > 0);
  CHECK(tank["energy"]["drained"] > 0);
  CHECK(tank["energy"]["delivered_most"] < 0.2 * none["energy"]["delivered_most"].get<double>());
  CHECK(coupling["energy"]["delivered_most"] < 0.5 * none["energy"]["delivered_most"].get<double>());
  Words words = wild;
  words.insert(words.end(), {"--passive", "tank"});
  words[1] = "auto";
  CHECK(run_json(words)["digest"] == tank["digest"]);
  const auto calm = run_json({"--transport", "memq", "--passive", "tank"});
  CHECK(calm["energy"]["delivered_most"] <= 1e-4);
  CHECK(calm["misses"] == 0);
}

TEST_CASE("a faster loop between steps feels what stepping as fast would, better than a force that is held") {
  const auto json = run_json({"--transport", "memq", "--fast-rate", "4000", "--script", "press"});
  const auto& fast = json["fast"];
  CHECK(json["cycles"] == 4000);
  CHECK(json["rate"] == 1000.0);
  CHECK(json["misses"] == 0);
  CHECK(json["allocations"] == 0);
  CHECK(fast["rate"] == 4000.0);
  CHECK(fast["cycles"] > 200);
  CHECK(fast["in_range"] > 0);
  CHECK(fast["local_work"] > 0);
  // few contacts, whose slips of a whole period differ from those of a quarter
  CHECK(fast["error_rms"] < fast["held_error_rms"]);
  CHECK(fast["error_rms"] < fast["step_error_rms"].get<double>() + 0.01);
  const ProgramRun odd = run_text({"--fast-rate", "2500"});
  CHECK(odd.exit_status == 1);
  CHECK(contains(odd.errors, "no multiple"));
  CHECK(run_text({"--fast-rate", "2000", "--tools", "4"}).exit_status == 1);
}

TEST_CASE("at random, starved and with lost messages, no energy comes out of nothing") {
  const ProgramRun run = run_program(GREENLOOP_LOOP, {workspace().model(), "--transport", "memq", "--script", "random",
                                                      "--seconds", "8", "--passive", "tank", "--json"});
  REQUIRE(run.exit_status == 0);
  const auto json = nlohmann::json::parse(run.output);
  CHECK(json["late_injected"] == 8000 / 97);
  CHECK(json["misses"] == 0);
  CHECK(json["contact_cycles"] > 1000);
  CHECK(json["energy"]["handled"] > 0);
  CHECK(json["energy"]["delivered_most"] <= 1e-4);
}

TEST_CASE("a stability map has loops on both sides of the bound, and those within it come to rest") {
  const std::string map = workspace().file("stability.csv");
  const ProgramRun run = run_text({"--stability", map, "--stability-steps", "2", "--hand", "absent", "--json"});
  INFO(run.output << run.errors);
  REQUIRE(run.exit_status == 0);
  const auto json = nlohmann::json::parse(run.output);
  CHECK(json["cells"] == 30);
  CHECK(json["within_bound"] == 15);
  CHECK(json["stable_within_bound"] == 15);
  CHECK(json["beyond_bound"] == 15);
  CHECK(json["stable_beyond_bound"] <= 3);
  std::ifstream lines(map);
  std::string line;
  std::getline(lines, line);
  CHECK(line == "rate,delay,stiffness,bound,early,late,largest,stable");
  int count = 0;
  while (std::getline(lines, line)) ++count;
  CHECK(count == 30);
}

TEST_CASE("a field now and then costs less and changes the digest") {
  const auto always = run_json({"--transport", "memq"});
  const auto seldom = run_json({"--transport", "memq", "--field", "16"});
  CHECK(seldom["misses"] == 0);
  CHECK(seldom["digest"] != always["digest"]);
}

TEST_CASE("the text for people says the same") {
  const ProgramRun held = run_text({"--transport", "memq"});
  CHECK(held.exit_status == 0);
  CHECK(contains(held.output, "HELD: 1000 of 1000 cycles at 1000 Hz, 0 misses, 0 late, 0 allocations"));
  const ProgramRun failed = run_text({"--transport", "memq", "--inject-overrun", "500"});
  CHECK(contains(failed.output, "VIOLATED: 1000 of 1000 cycles at 1000 Hz, 1 misses, 1 late"));
  CHECK(contains(failed.output, "first miss in cycle 500"));
  CHECK(held.output.find("\ntime NOT JUDGED: p50 ") < held.output.find("  model "));
  CHECK(contains(held.output, "the period is 1000 us, of which a step may take 100 %"));
}

TEST_CASE("rate and share are the model's unless they are given") {
  const std::string file = workspace().file("fast.gloop");
  ModelData data = synthetic_model({.levels = 3, .touchable_above = -0.2});
  data.info.rate = 4000;
  data.info.share = 0.25F;
  write_file(file, encode(data));
  const auto run_fast = [&](const Words& more) {
    Words words{file, "--seconds", "0.5", "--transport", "memq", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return nlohmann::json::parse(run_program(GREENLOOP_LOOP, words).output);
  };
  const auto own = run_fast({});
  CHECK(own["rate"] == 4000);
  CHECK(own["cycles"] == 2000);
  CHECK(own["time"]["period_us"] == 250);
  CHECK(own["time"]["share"] == 0.25);
  const auto given = run_fast({"--rate", "500", "--share", "0.5"});
  CHECK(given["cycles"] == 250);
  CHECK(given["time"]["period_us"] == 2000);
  CHECK(given["time"]["share"] == 0.5);
  data.info.rate = 50;
  write_file(file, encode(data));
  const ProgramRun slow = run_program(GREENLOOP_LOOP, {file});
  CHECK(slow.exit_status == 1);
  CHECK(contains(slow.errors, file + ": rate: 50"));
  CHECK(contains(slow.errors, "give another with --rate"));
}

TEST_CASE("time is reported beside the work, and judged only when asked for, where the machine can judge") {
  const auto reported = run_json({"--transport", "memq"});
  CHECK(reported["verdict"] == "HELD");
  CHECK(reported["time_verdict"] == "NOT JUDGED");
  CHECK(reported["time"]["p50_us"] <= reported["time"]["p999_us"]);
  CHECK(reported["time"]["worst_us"] == reported["step_us"]["max"]);
  const ProgramRun asked = run_text({"--transport", "memq", "--judge-time", "--json"});
  const auto judged = nlohmann::json::parse(asked.output);
  CHECK(judged["verdict"] == "HELD");
  if (judged["time"]["can_judge"] == true) {
    CHECK(judged["time_verdict"] == (judged["time"]["within"] == true ? "WITHIN" : "LATE"));
    CHECK(asked.exit_status == (judged["time"]["within"] == true ? 0 : 1));
  } else {
    CHECK(judged["time_verdict"] == "NOT JUDGED");
    CHECK(judged["passed"] == false);
    CHECK(asked.exit_status == 1);
  }
}

TEST_CASE("a file that is no model, and words that are no options, are refused") {
  const std::string broken = workspace().file("broken.gloop");
  std::ofstream(broken) << "not a model";
  const ProgramRun no_model = run_program(GREENLOOP_LOOP, {broken});
  CHECK(no_model.exit_status == 1);
  CHECK(contains(no_model.errors, broken));
  CHECK(run_program(GREENLOOP_LOOP, {workspace().file("absent.gloop")}).exit_status == 1);
  const std::string scalar = workspace().file("scalar.gloop");
  write_file(scalar, encode(synthetic_model({.components = 1, .levels = 2})));
  const ProgramRun another_problem = run_program(GREENLOOP_LOOP, {scalar});
  CHECK(another_problem.exit_status == 1);
  CHECK(contains(another_problem.errors, scalar + ": this is a scalar model; only elastostatic ones are taken here"));
  CHECK(run_text({"--inject-delay", "7"}).exit_status == 2);
  CHECK(run_text({"--starve", "0"}).exit_status == 2);
  CHECK(run_text({"--starve", "1.5"}).exit_status == 2);
  CHECK(run_text({"--script", "juggle"}).exit_status == 2);
  CHECK(run_program(GREENLOOP_LOOP, {}).exit_status == 2);
}

}  // namespace
}  // namespace greenloop
