// What inspect says of the budget that a model is meant for.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/write/model_file.hpp"
#include "offline/cli/inspect_command.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::json;

Json inspected(const std::filesystem::path& file) {
  std::ostringstream out;
  CHECK(run_inspect({file, true}, out) == 0);
  return Json::parse(out.str())["budget"];
}

TEST_CASE("inspect --json: the budget is the file's, what it costs here is measured") {
  ModelData data = synthetic_model({.levels = 4, .touchable_above = -0.2});
  data.info.rate = 4000;
  data.info.share = 0.4F;
  data.info.max_contacts = 6;
  data.info.step_work = 300000;
  const TemporaryFolder folder("inspect_budget_test");
  const std::filesystem::path own = folder.path() / "own.gloop";
  write_file(own, encode(data));
  const Json budget = inspected(own);
  CHECK(budget["work"] == 300000);
  CHECK(budget["rate"] == 4000);
  CHECK(budget["share"] == 0.4);
  CHECK(budget["share_us"] == doctest::Approx(100));
  CHECK(budget["contacts"] == 6);
  const ModelFile file = open_model_file(own);
  const Model model = Model::open(file.bytes.span()).model;
  const auto need = Elastostatic::required(model, {.max_contacts = 6});
  CHECK(budget["least_work"] == need.least_work);
  CHECK(budget["worst_work"] == *std::max_element(need.worst_work, need.worst_work + 4));
  CHECK(budget["arena_bytes"] == need.bytes);
  CHECK(budget["create_ms"] > 0);
  CHECK(budget["steps"] > 1);
  CHECK(budget["us"].get<double>() == doctest::Approx(300000 / budget["units_per_us"].get<double>()));
  CHECK(budget["us_p95"] >= budget["us"]);
  CHECK(budget["least_us"].get<double>() / budget["us"].get<double>() ==
        doctest::Approx(static_cast<double>(need.least_work) / 300000));
  CHECK(budget["worst_us"] > budget["least_us"]);
}

TEST_CASE("inspect --json: without a share a step may take the whole period; a body too large is not made") {
  ModelData data = synthetic_model({.levels = 6});
  data.info.max_contacts = 4096;
  const TemporaryFolder folder("inspect_budget_test");
  write_file(folder.path() / "large.gloop", encode(data));
  const Json budget = inspected(folder.path() / "large.gloop");
  CHECK(budget["share"] == 1);
  CHECK(budget["share_us"] == 1000);
  REQUIRE(budget["arena_bytes"] > std::size_t{1} << 30);
  for (const char* key : {"us", "us_p95", "least_us", "worst_us", "units_per_us", "create_ms"}) {
    CAPTURE(key);
    CHECK(budget.at(key).is_null());
  }
}

}  // namespace
}  // namespace greenloop::offline
