#include "offline/report/build_record.hpp"

#include <doctest/doctest.h>

#include "offline/report/temporary_file.hpp"

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
    "compression": {"epsilon": 0.02, "curve": [
      {"epsilon": 0.1, "rms_error": 0.05, "bytes": 100, "sum_work": 10},
      {"epsilon": 0.02, "rms_error": 0.01, "bytes": 300, "kept_blocks": 5, "worst_column_error": 0.04}]}})"));
  CHECK(record.scene == "bear.toml");
  REQUIRE(record.stages.size() == 1);
  CHECK(record.stages[0].seconds == 2.5);
  REQUIRE(record.remesh.size() == 3);
  CHECK(record.remesh[1].name == "hausdorff");
  CHECK(record.remesh[1].value == "0.4\u202f%");
  CHECK(record.remesh[2].value == "21.5\u202f°");
  REQUIRE(record.solve.size() == 3);
  CHECK(record.solve[2].name == "seconds");
  CHECK(record.epsilon == 0.02);
  REQUIRE(record.curve.size() == 2);
  CHECK(record.curve[0].epsilon == 0.02);
  CHECK(record.curve[0].worst_column_error == 0.04);
  CHECK_FALSE(record.curve[0].sum_work);
  CHECK(record.curve[1].sum_work == 10);
}

TEST_CASE("every part of a build record may be missing") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write("b.json", R"({"stages": null, "compression": {}})"));
  CHECK(record.stages.empty());
  CHECK(record.curve.empty());
  CHECK_FALSE(record.epsilon);
}

TEST_CASE("points that cannot stand on a logarithmic axis are left out") {
  const TemporaryFolder folder("build_record_test");
  const auto record = load_build_record(folder.write(
      "b.json",
      R"({"compression": {"curve": [{"epsilon": 0, "rms_error": 0}, {"rms_error": 1}, {"epsilon": 1, "rms_error": 0.5}]}})"));
  REQUIRE(record.curve.size() == 1);
  CHECK(record.curve[0].epsilon == 1);
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
  CHECK(mentions(refusal(R"({"compression": {"epsilon": "x"}})"), "'epsilon' is string, expected a number"));
}

TEST_CASE("provenance becomes facts; what is no object becomes none") {
  const auto facts = facts_of_json(R"({"mesh": {"file": "bear.off", "vertices": 10096}, "ok": true})");
  REQUIRE(facts.size() == 3);
  CHECK(facts[0].name == "mesh / file");
  CHECK(facts[1].value == "10\u202f096");
  CHECK(facts[2].value == "yes");
  CHECK(facts_of_json("plain text").empty());
}

}  // namespace greenloop::offline
