#include "offline/report/verdict.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "formats/testing/synthetic_model.hpp"
#include "formats/write/writer.hpp"

namespace greenloop::offline {
namespace {

constexpr const char* scene =
    R"("scene_text": "[surface]\nfile = \"a.off\"\nunit = \"m\"\n[material]\nyoung = \"1 kPa\"\n)"
    R"(poisson = 0.3\n[[fixed]]\nbelow = 0.1\naxis = \"z\"\n[accuracy]\nrms = 0.02\n)"
    R"(worst_column = 0.1\npatch_force = 0.05\nmesh_error = 0.05\n")";

// with errors of its finest level, of a scene that asks for 2, 10, 5 and 5 %
ModelFile model_with(float patch_force, const char* mesh_error, const char* asked = scene) {
  ModelData data = synthetic_model({.levels = 2});
  for (LevelData& level : data.levels) {
    level.counts.rms_error = 0.01F;
    level.counts.worst_column_error = 0.04F;
    level.counts.patch_force_error = patch_force;
  }
  data.info.lambda_min = 1e-5;
  data.provenance = std::string("{") + asked + R"(, "mesh_error": {"force": )" + mesh_error + "}}";
  return encoded_file(data);
}

const Judgement& row(const Verdict& verdict, const std::string& begin) {
  const auto at = std::find_if(verdict.rows.begin(), verdict.rows.end(),
                               [&](const Judgement& one) { return one.what.starts_with(begin); });
  REQUIRE(at != verdict.rows.end());
  return *at;
}

}  // namespace

TEST_CASE("a model whose errors are within what its scene asks is good enough") {
  const Verdict verdict = verdict_of(model_with(0.04F, "0.03"), {}, {});
  REQUIRE(verdict.good);
  CHECK(*verdict.good);
  CHECK(verdict.sentence == "Good enough: all errors are within what is asked.");
  const Judgement& force = row(verdict, "compression error, forces of a patch");
  CHECK(force.asked == "5\u202f%");
  CHECK(force.reached == "4\u202f%");
  CHECK(force.held == true);
  CHECK(row(verdict, "positive definite").held == true);
  CHECK(row(verdict, "RAM").reached.ends_with("B"));
}

TEST_CASE("one error beyond what is asked, and the verdict names it") {
  const Verdict compression = verdict_of(model_with(0.08F, "0.03"), {}, {});
  CHECK(compression.good == false);
  CHECK(row(compression, "compression error, forces of a patch").held == false);
  CHECK(row(compression, "mesh error").held == true);
  const Verdict mesh = verdict_of(model_with(0.04F, "1.33"), {}, {});
  CHECK(mesh.good == false);
  CHECK(mesh.sentence.starts_with("Not good enough: the mesh error is 133 % where 5 % is asked"));
  CHECK(row(mesh, "mesh error").reached == "133\u202f%");
}

TEST_CASE("a mesh error of which nothing is asked stands in the sentence and in a row that is not judged") {
  std::string silent = scene;
  const std::string goal = R"(mesh_error = 0.05\n)";
  silent.erase(silent.find(goal), goal.size());
  const Verdict verdict = verdict_of(model_with(0.04F, "1.33", silent.c_str()), {}, {});
  CHECK(verdict.good == true);
  CHECK(verdict.sentence.starts_with("As asked: all errors are within what is asked; warning: the tetrahedra make"));
  CHECK(verdict.sentence.find("133 %") != std::string::npos);
  CHECK_FALSE(row(verdict, "mesh error").held);
  CHECK(row(verdict, "mesh error").reached == "133\u202f%");
}

TEST_CASE("a run that missed cycles is not good enough, whatever the errors") {
  const TraceSummary punctual{.cycles = 1000, .worst_share = 0.5},
      late{.cycles = 1000, .misses = 3, .worst_share = 1.5};
  CHECK(verdict_of(model_with(0.04F, "0.03"), {}, punctual).good == true);
  const Verdict verdict = verdict_of(model_with(0.04F, "0.03"), {}, late);
  CHECK(verdict.good == false);
  CHECK(verdict.sentence.starts_with("Not good enough: 3 of 1000 cycles of the run were missed; all errors"));
  CHECK(row(verdict, "missed cycles").held == false);
}

TEST_CASE("without the scene nothing is judged; time is at the record's speed") {
  BuildRecord record;
  record.units_per_us = 500;
  const ModelFile model = model_with(0.04F, "0.03", R"("scene": "x")");
  const Verdict verdict = verdict_of(model, record, {});
  CHECK_FALSE(verdict.good);
  CHECK(verdict.sentence.starts_with("Not judged"));
  CHECK(row(verdict, "compression error, forces of a patch").asked == "–");
  CHECK(row(verdict, "the budget in time, at 500 units").reached.ends_with("µs"));
}

TEST_CASE("provenance that is not a build's is no scene") {
  const std::string deep(60, '[');
  for (const std::string& text :
       {deep, R"({"scene_text": )" + deep, std::string(R"({"scene_text": 3, "mesh_error": []})"),
        std::string(R"({"scene_text": "rubbish", "mesh_error": {"force": "x"}})")}) {
    ModelData data = synthetic_model({.levels = 2});
    data.provenance = text;
    const Verdict verdict = verdict_of(encoded_file(data), {}, {});
    CHECK_FALSE(verdict.good);
    CHECK(verdict.sentence.starts_with("Not judged"));
  }
}

}  // namespace greenloop::offline
