#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/synthetic_motion.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "runtime/model.hpp"
#include "runtime/wavelet/domain.hpp"
#include "sim_hw/session/testing/program_run.hpp"

namespace greenloop {
namespace {

using Words = std::vector<std::string>;

/// A folder with motions in it, and a body that is touched.
class Workspace {
 public:
  Workspace() {
    write_file(file("motion.gloop"),
               encode(synthetic_motion({.vertices = 333, .modes = 12, .groups = 3, .planes = 2, .alternating = true})));
    write_file(file("sphere.gloop"), encode(synthetic_model({.levels = 2})));
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.path() / name; }

 private:
  TemporaryFolder folder_{"greenloop_motion_session"};
};

const Workspace& workspace() {
  static const Workspace only;
  return only;
}

/// Four seconds of impulses.
ProgramRun run_text(const Words& more, const std::string& model = "motion.gloop") {
  Words words{workspace().file(model), "--seconds", "4", "--rate", "1000"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(GREENLOOP_LOOP, words);
}

/// The same, its JSON read; the exit status must be `expected`.
nlohmann::json run_json(Words more, int expected = 0) {
  more.insert(more.end(), {"--script", "impulses", "--json"});
  const ProgramRun run = run_text(more);
  INFO(run.output << run.errors);
  REQUIRE(run.exit_status == expected);
  return nlohmann::json::parse(run.output);
}

TEST_CASE("impulses in one process: every cycle holds its budget, what is wrong is refused, and nothing jumps") {
  const auto json = run_json({"--transport", "memq"});
  CHECK(json["passed"] == true);
  CHECK(json["verdict"] == "HELD");
  CHECK(json["cycles"] == 4000);
  CHECK(json["misses"] == 0);
  CHECK(json["allocations"] == 0);
  CHECK(json["impulses"] > 3);
  CHECK(json["refused"]["illegal"] > 0);
  CHECK(json["refused"]["not_held"] == 0);
  CHECK(json["worst_work"] <= json["budget_work"]);
  CHECK(json["frames"]["every"] == 17);
  CHECK(json["frames"]["count"] > 200);
  CHECK(json["frames"]["coarser"] == 0);
  CHECK(json["frames"]["least_rank"] == 12);
  for (const std::string what : {"position", "velocity"}) {
    CHECK(json[what + "_jump_max"] > 0);
    CHECK(json[what + "_jump_max"] <= json[what + "_jump_bound"]);
  }
  CHECK(json["energy_max"] > 0);
  CHECK(json["energy_max"] <= json["energy_bound"]);
  CHECK(run_json({"--transport", "memq"})["digest"] == json["digest"]);
}

TEST_CASE("impulses between two processes, where they are permitted, have the same digest") {
  const auto one = run_json({"--transport", "memq"}), two = run_json({});
  CHECK(one["processes"] == 1);
  CHECK((two["processes"] == 2 || two.contains("reason")));
  CHECK(two["digest"] == one["digest"]);
}

TEST_CASE("a small budget means coarser frames, never a miss, and none at all is refused") {
  const auto whole = run_json({"--transport", "memq"});
  const auto json = run_json({"--transport", "memq", "--budget", std::to_string(whole["least_work"].get<int>() + 50)});
  CHECK(json["misses"] == 0);
  CHECK(json["frames"]["coarser"] == json["frames"]["count"]);
  CHECK(json["frames"]["least_rank"] < 12);
  CHECK(json["frames"]["truncation_error"] > whole["frames"]["truncation_error"]);
  const ProgramRun refused = run_text({"--budget", std::to_string(whole["least_work"].get<int>() - 1)});
  CHECK(refused.exit_status == 1);
  CHECK(refused.errors.find("cannot hold even the coarsest frame; the least budget of this model is " +
                            whole["least_work"].dump()) != std::string::npos);
}

TEST_CASE("lost commands are counted and leave the scene as it was, and an overspent cycle is a miss") {
  const auto lost = run_json({"--transport", "memq", "--inject-loss", "7"});
  CHECK(lost["late"] == 4000 / 7);
  CHECK(lost["late_injected"] == lost["late"]);
  CHECK(lost["digest"] == run_json({"--transport", "memq"})["digest"]);
  const auto overrun = run_json({"--transport", "memq", "--inject-overrun", "500"}, 1);
  CHECK(overrun["verdict"] == "VIOLATED");
  CHECK(overrun["misses"] == 1);
  CHECK(run_json({"--transport", "memq", "--inject-delay", "100:30"}, 1)["stopped"] == true);
}

TEST_CASE("the trace of impulses has a line for each cycle") {
  const std::string file = workspace().file("trace.csv");
  const auto json = run_json({"--transport", "memq", "--field", "1", "--trace", file});
  CHECK(json["frames"]["every"] == 1);
  std::ifstream trace(file);
  std::string line;
  REQUIRE(std::getline(trace, line));
  CHECK(line == "time,impulse,orbit,row,position,velocity,blend,distance,rank,truncation_error,work,budget,status");
  int lines = 0, refused = 0;
  for (; std::getline(trace, line); ++lines) refused += line.ends_with(",held_illegal_impulse") ? 1 : 0;
  CHECK(lines == 4000);
  CHECK(refused == json["refused"]["illegal"]);
}

TEST_CASE("what motions have not is refused by name, and impulses are for motions alone") {
  const auto refusal = [](const Words& words, const std::string& model = "motion.gloop") {
    const ProgramRun run = run_text(words, model);
    CHECK(run.exit_status == 1);
    return run.errors;
  };
  CHECK(refusal({"--script", "press"}).find("--script press: a model of motions has impulses alone") !=
        std::string::npos);
  CHECK(refusal({"--hand", "absent"}).find("--hand: not for a model of motions") != std::string::npos);
  CHECK(refusal({"--script", "impulses"}, "sphere.gloop").find("this is no model of motions") != std::string::npos);
}

/// Motions of the sphere's nodes.
void write_vibration(const std::string& file) {
  const ModelData sphere = synthetic_model({.levels = 2});
  const AlignedBytes bytes(encode(sphere));
  const auto opened = Model::open(bytes.span());
  REQUIRE(opened);
  const std::uint32_t nodes = opened.model.node_count();
  ImpulseResponseData data = synthetic_motion({.vertices = nodes, .modes = 6, .alternating = true});
  for (std::uint32_t i = 0; i < nodes; ++i) {
    std::copy_n(node_record(opened.model.view(), i).position, 3, data.shape.begin() + std::ptrdiff_t{3} * i);
  }
  write_file(file, encode(data));
}

TEST_CASE("a body that vibrates is pressed and slid along: every cycle holds, impulses come with the tools' places") {
  const std::string motions = workspace().file("vibration.gloop");
  write_vibration(motions);
  const auto run = [&](Words more, int expected = 0) {
    more.insert(more.end(), {"--motions", motions, "--script", "slide", "--friction", "0.4", "--json"});
    const ProgramRun ran = run_text(more, "sphere.gloop");
    INFO(ran.output << ran.errors);
    REQUIRE(ran.exit_status == expected);
    return nlohmann::json::parse(ran.output);
  };
  const auto one = run({"--transport", "memq"}), two = run({});
  CHECK(one["verdict"] == "HELD");
  CHECK(one["misses"] == 0);
  CHECK(one["allocations"] == 0);
  CHECK(one["contact_cycles"] > 100);
  CHECK(one["worst_work"] <= one["budget_work"]);
  CHECK(one["impulses"] > 3);
  CHECK(one["refused"]["illegal"] > 0);
  CHECK(one["motions"]["offset_max"] > 0);
  CHECK(one["motions"]["coarser"] == 0);
  CHECK(one["energy"]["dissipated"] > 0);
  CHECK(one["tools"].size() == 1);
  CHECK((two["processes"] == 2 || two.contains("reason")));
  CHECK(two["digest"] == one["digest"]);
  const auto still = nlohmann::json::parse(
      run_text({"--script", "slide", "--friction", "0.4", "--transport", "memq", "--json"}, "sphere.gloop").output);
  CHECK(still["digest"] != one["digest"]);
  const auto starved = run({"--transport", "memq", "--budget", one["least_work"].dump()});
  CHECK(starved["misses"] == 0);
  CHECK(starved["motions"]["coarser"] > 0);
  const ProgramRun other = run_text({"--motions", workspace().file("motion.gloop")}, "sphere.gloop");
  CHECK(other.exit_status == 1);
  CHECK(other.errors.find("--motions: not of the same surface") != std::string::npos);
}

}  // namespace
}  // namespace greenloop
