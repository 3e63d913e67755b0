// What inspect says of a multigrid model.

#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_multigrid.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "offline/cli/inspect_command.hpp"

namespace greenloop::offline {
namespace {

std::string inspected(const SyntheticMultigrid& options, bool json) {
  const TemporaryFolder folder("inspect_elastic_test");
  const std::filesystem::path file = folder.path() / "beam.gloop";
  write_file(file, encode(synthetic_multigrid(options)));
  std::ostringstream out;
  CHECK(run_inspect({.file = file, .json = json}, out) == 0);
  return out.str();
}

TEST_CASE("inspect: a multigrid model's grids, body and work") {
  const auto json = nlohmann::json::parse(inspected({}, true));
  CHECK(json["kind"] == "multigrid");
  CHECK(json["version"] == "4.9");
  CHECK(json["strain"] == "corotational");
  CHECK(json["tetrahedra"] == 12);
  const auto& levels = json["levels"];
  REQUIRE(levels.size() == 3);
  CHECK(levels[0]["nodes"] == 8);
  CHECK(levels[0]["tetrahedra"] == 12);
  CHECK(levels[1]["tetrahedra"].is_null());
  CHECK(levels[2]["nodes"] == 2);
  CHECK(levels[2]["bytes"] == 21 * 8);
  CHECK(json["step_work"]["least"] > json["step_work"]["cycle"]);
  CHECK(json["cycles"] >= 1);
  CHECK(json["cycles"] <= 50);
  const auto one = nlohmann::json::parse(inspected({.cells = 1, .grids = 1}, true));
  CHECK(one["levels"].size() == 1);
  CHECK(one["levels"][0]["tetrahedra"] == 6);
  const std::string table = inspected({}, false);
  CHECK(table.find("12 tetrahedra, 12 vertices, 8 of them free, 1 materials") != std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
