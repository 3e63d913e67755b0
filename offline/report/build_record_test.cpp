#include "offline/report/build_record.hpp"

#include <doctest/doctest.h>

#include "formats/testing/temporary_folder.hpp"
#include "offline/report/axis.hpp"
#include "offline/report/testing/message_of.hpp"

namespace greenloop::offline {
namespace {

bool mentions(const std::string& message, std::string_view part) { return message.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a complete build record") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write("b.json", R"({
    "scene": "bear.toml", "stages": [{"name": "remesh", "seconds": 2.5}],
    "remesh": {"base_vertices": 42, "smallest_angle_degrees": 21.5, "hausdorff_relative": 0.004},
    "solve": {"columns": 2100, "seconds": 33.25, "asymmetry": 1e-9},
    "compression": {"threshold": 0.02, "patches": 64, "frontier_contacts": 16, "frontier": [
      {"threshold": 0.1, "rms_error": 0.05, "bytes": 100, "step_work": 10, "worst_patch_force_error": 0.3},
      {"threshold": 0.02, "rms_error": 0.01, "bytes": 300, "kept_blocks": 5, "worst_column_error": 0.04,
       "levels": [{"level": 0, "bytes": 30, "worst_patch_force_error": 1e9}, {"rms_error": 1}]}]}})"));
  CHECK(record.scene == "bear.toml");
  REQUIRE(record.stages.size() == 1);
  CHECK(record.stages[0].seconds == 2.5);
  REQUIRE(record.groups.size() == 2);
  const auto& remesh = record.groups[0].facts;
  REQUIRE(remesh.size() == 3);
  CHECK(remesh[1].name == "hausdorff");
  CHECK(remesh[1].value == "0.4\u202f%");
  CHECK(remesh[2].value == "21.5\u202f°");
  REQUIRE(record.groups[1].facts.size() == 3);
  CHECK(record.groups[1].facts[2].name == "seconds");
  CHECK(record.threshold == 0.02);
  CHECK(record.patches == 64);
  REQUIRE(record.frontier.size() == 2);
  CHECK(record.frontier[0].threshold == 0.02);
  CHECK(record.frontier[0].worst_column_error == 0.04);
  CHECK(record.frontier[0].kept_blocks == 5);
  CHECK_FALSE(record.frontier[0].step_work);
  CHECK(record.contacts == 16);
  REQUIRE(record.frontier[0].levels.size() == 1);
  CHECK(record.frontier[0].levels[0].bytes == 30);
  CHECK_FALSE(record.frontier[0].levels[0].worst_patch_force_error);
  CHECK(record.frontier[1].levels.empty());
  CHECK(record.frontier[1].step_work == 10);
  CHECK(record.frontier[1].worst_patch_force_error == 0.3);
}

TEST_CASE("wavelets that were compared are facts") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write("b.json", R"({"compression": {"wavelets": [
      {"wavelet": "linear", "nodes": 558, "meets": true, "bytes": 100000, "kept_blocks": 5000, "step_work": 70000},
      {"wavelet": "butterfly", "nodes": 558, "meets": false}]}})"));
  REQUIRE(record.groups.size() == 1);
  const auto& [title, facts] = record.groups[0];
  CHECK(title == "Wavelets compared");
  REQUIRE(facts.size() == 2);
  CHECK(facts[0].name == "linear on 558 nodes");
  CHECK(facts[0].value ==
        readable_bytes(100000) + ", " + readable_count(5000) + " blocks, " + readable_count(70000) + " units per step");
  CHECK(facts[1].value == "cannot meet the errors asked for");
}

TEST_CASE("every part of a build record may be missing") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write("b.json", R"({"stages": null, "compression": {}})"));
  CHECK(record.stages.empty());
  CHECK(record.frontier.empty());
  CHECK_FALSE(record.threshold);
}

TEST_CASE("what cannot stand on a logarithmic axis is left out") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write("b.json", R"({"compression": {"frontier": [{"rms_error": 1},
    {"threshold": 1, "rms_error": 0, "bytes": 7, "worst_patch_force_error": 1e9}]}})"));
  REQUIRE(record.frontier.size() == 1);
  CHECK(record.frontier[0].bytes == 7);
  CHECK_FALSE(record.frontier[0].rms_error);
  CHECK_FALSE(record.frontier[0].worst_patch_force_error);
}

TEST_CASE("of several points with one threshold the one with the worse patch force is kept") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write("b.json", R"({"compression": {"frontier": [
    {"threshold": 0.5, "worst_patch_force_error": 0.1}, {"threshold": 0.2, "worst_patch_force_error": 0.03},
    {"threshold": 0.2, "worst_patch_force_error": 0.04}, {"threshold": 0.2, "worst_patch_force_error": 0.02}]}})"));
  REQUIRE(record.frontier.size() == 2);
  CHECK(record.frontier[0].threshold == 0.2);
  CHECK(record.frontier[0].worst_patch_force_error == 0.04);
  CHECK(record.frontier[1].worst_patch_force_error == 0.1);
}

TEST_CASE("a wrong build record is refused with file and key") {
  const TemporaryFolder folder("build_record_test");
  const auto refusal = [&](const std::string& content) {
    return message_of([&] { (void)load_build_record(folder.write("b.json", content)); });
  };
  CHECK(mentions(refusal("{"), "b.json: no JSON"));
  CHECK(mentions(refusal("[]"), "expected an object"));
  CHECK(mentions(refusal(R"({"stages": 3})"), "'stages' is number, expected an array"));
  CHECK(mentions(refusal(R"({"stages": [3]})"), "an element of 'stages' is number"));
  CHECK(mentions(refusal(R"({"compression": {"threshold": "x"}})"), "'threshold' is string, expected a number"));
  CHECK(mentions(refusal(R"({"compression": {"frontier": [1]}})"), "an element of 'frontier' is number"));
  CHECK(mentions(refusal(R"({"compression": {"frontier": [{"threshold": 1, "levels": [1]}]}})"),
                 "an element of 'levels' is number"));
  CHECK(mentions(refusal(R"({"scene": )" + std::string(20'000, '[') + std::string(20'000, ']') + "}"),
                 "opens more than 64 levels of brackets"));
  CHECK(mentions(refusal(std::string(20'000, '[')), "opens more than 64 levels of brackets"));
}

TEST_CASE("counts and figures beyond any that are written are left out; no number is beyond its type") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write("b.json", R"({"bytes": 1e300, "compression": {"patches": 1e30,
      "frontier_contacts": -1, "wavelets": [{"wavelet": "linear", "nodes": 1e300, "bytes": 1e300, "kept_blocks": 1e-300}],
      "frontier": [{"threshold": 1, "bytes": 1e300, "step_work": 1e-300}]}})"));
  CHECK_FALSE(record.model_bytes);
  CHECK_FALSE(record.patches);
  CHECK_FALSE(record.contacts);
  REQUIRE(record.frontier.size() == 1);
  CHECK_FALSE(record.frontier[0].bytes);
  CHECK_FALSE(record.frontier[0].step_work);
  CHECK(
      mentions(message_of([&] { (void)load_build_record(folder.write("b.json", R"({"bytes": 1e999})")); }), "no JSON"));
}

TEST_CASE("provenance becomes groups of facts; what is no object becomes none") {
  auto groups = facts_of_json(
      R"({"mesh": {"file": "bear.off", "vertices": 10096, "repairs": [], "box": [1, 2]}, "ok": true})", "Provenance");
  REQUIRE(groups.size() == 2);
  CHECK(groups[0].title == "Provenance");
  CHECK(groups[0].facts[0].value == "yes");
  CHECK(groups[1].title == "mesh");
  CHECK(groups[1].facts[0].value == "1, 2");
  CHECK(groups[1].facts[2].value == "none");
  CHECK(groups[1].facts[3].value == "10\u202f096");
  CHECK(facts_of_json("plain text", "").empty());
  CHECK(facts_of_json(R"({"deep": )" + std::string(20'000, '[') + std::string(20'000, ']') + "}", "").empty());
  merge_facts(groups, {{"mesh", {{"file", "other.off"}, {"genus", "0"}}}, {"solve", {{"columns", "3"}}}});
  REQUIRE(groups.size() == 3);
  REQUIRE(groups[1].facts.size() == 5);
  CHECK(groups[1].facts[1].value == "bear.off");
  CHECK(groups[1].facts[4].name == "genus");
}

}  // namespace greenloop::offline
