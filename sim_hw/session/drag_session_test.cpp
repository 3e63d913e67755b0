#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/synthetic_multigrid.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "sim_hw/session/testing/program_run.hpp"

namespace greenloop {
namespace {

using Words = std::vector<std::string>;

/// A folder with a beam that moves in it, and a body that is touched.
class Workspace {
 public:
  Workspace() {
    write_file(file("beam.gloop"), encode(synthetic_multigrid({.cells = 4})));
    write_file(file("sphere.gloop"), encode(synthetic_model({.levels = 2})));
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.path() / name; }

 private:
  TemporaryFolder folder_{"greenloop_drag_session"};
};

const Workspace& workspace() {
  static const Workspace only;
  return only;
}

/// Four seconds of dragging.
ProgramRun run_text(const Words& more, const std::string& model = "beam.gloop") {
  Words words{workspace().file(model), "--seconds", "4"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(GREENLOOP_LOOP, words);
}

/// The same, its JSON read; the exit status must be `expected`.
nlohmann::json run_json(Words more, int expected = 0) {
  more.insert(more.end(), {"--script", "drag", "--json"});
  const ProgramRun run = run_text(more);
  INFO(run.output << run.errors);
  REQUIRE(run.exit_status == expected);
  return nlohmann::json::parse(run.output);
}

TEST_CASE("a beam is dragged in one process: every cycle holds its budget and nothing gets far") {
  const auto json = run_json({"--transport", "memq"});
  CHECK(json["passed"] == true);
  CHECK(json["verdict"] == "HELD");
  CHECK(json["script"] == "drag");
  CHECK(json["cycles"] == 4000);
  CHECK(json["misses"] == 0);
  CHECK(json["allocations"] == 0);
  CHECK(json["refused"] == 0);
  CHECK(json["grasps"] == 3);
  CHECK(json["worst_work"] <= json["budget_work"]);
  CHECK(json["worst_work"] >= json["least_work"].get<double>() / 2);
  CHECK(json["multigrid_cycles"]["max"] >= 1);
  CHECK(json["force_max"] > 0);
  CHECK(json["displacement_max"] > 0.001);
  CHECK(json["displacement_max"] < json["displacement_bound"]);
  CHECK(json["energy"]["kinetic_end"] < json["energy"]["kinetic_max"]);
}

TEST_CASE("two processes drag as one does, to the bit") {
  const auto two = run_json({"--transport", "auto"});
  CHECK(two["digest"] == run_json({"--transport", "memq"})["digest"]);
}

TEST_CASE("a starved drag holds its budget, and one below the least is refused by number") {
  const auto whole = run_json({"--transport", "memq"});
  const auto least = std::to_string(whole["least_work"].get<int>());
  const auto starved = run_json({"--transport", "memq", "--budget", least});
  CHECK(starved["misses"] == 0);
  CHECK(starved["multigrid_cycles"]["max"] == 1);
  CHECK(starved["residual"]["mean"] >= whole["residual"]["mean"]);
  const ProgramRun refused =
      run_text({"--script", "drag", "--budget", std::to_string(whole["least_work"].get<int>() - 1)});
  CHECK(refused.exit_status == 1);
  CHECK(refused.errors.find("the least budget of this model is " + least) != std::string::npos);
}

TEST_CASE("lost commands leave the body as it was, and an overspent cycle of a drag is a miss") {
  const auto lost = run_json({"--transport", "memq", "--inject-loss", "7"});
  CHECK(lost["late"] == 4000 / 7);
  CHECK(lost["late_injected"] == lost["late"]);
  CHECK(lost["digest"] == run_json({"--transport", "memq"})["digest"]);
  const auto overrun = run_json({"--transport", "memq", "--inject-overrun", "500"}, 1);
  CHECK(overrun["verdict"] == "VIOLATED");
  CHECK(overrun["misses"] == 1);
}

TEST_CASE("the trace of a drag has a line for each cycle, the snapshot one for each shown vertex") {
  const std::string trace_file = workspace().file("trace.csv"), snapshot = workspace().file("snapshot.csv");
  (void)run_json({"--transport", "memq", "--trace", trace_file, "--snapshot", snapshot});
  std::ifstream trace(trace_file);
  std::string line;
  REQUIRE(std::getline(trace, line));
  CHECK(line == "time,vertex,force,displacement,kinetic,elastic,residual,cycles,work,budget,status");
  int lines = 0, dragged = 0;
  for (; std::getline(trace, line); ++lines) dragged += line.find(",-1,") == std::string::npos ? 1 : 0;
  CHECK(lines == 4000);
  CHECK(dragged == 2500);
  std::ifstream shown(snapshot);
  int vertices = -1;
  for (; std::getline(shown, line); ++vertices) {
  }
  CHECK(vertices == static_cast<int>(synthetic_multigrid({.cells = 4}).shown_points.size() / 3));
}

TEST_CASE("a multigrid model has one script, and says so") {
  const auto refusal = [](const Words& words, const std::string& model = "beam.gloop") {
    const ProgramRun run = run_text(words, model);
    CHECK(run.exit_status == 1);
    return run.errors;
  };
  CHECK(refusal({}).find("a multigrid model has the script drag: give --script drag") != std::string::npos);
  CHECK(refusal({"--script", "press"}).find("--script press: a multigrid model has drag alone") != std::string::npos);
  CHECK(refusal({"--script", "drag", "--rate", "500"}).find("--rate: not for a multigrid model") != std::string::npos);
  CHECK(refusal({"--script", "drag"}, "sphere.gloop").find("this is no multigrid model") != std::string::npos);
}

}  // namespace
}  // namespace greenloop
