// What inspect says of a model's loads.

#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "offline/cli/inspect_command.hpp"

namespace greenloop::offline {
namespace {

std::string inspected(const SyntheticOptions& options, bool json) {
  const TemporaryFolder folder("inspect_loads_test");
  const std::filesystem::path file = folder.path() / "own.gloop";
  write_file(file, encode(synthetic_model(options)));
  std::ostringstream out;
  CHECK(run_inspect({.file = file, .json = json}, out) == 0);
  return out.str();
}

TEST_CASE("inspect: names a model's loads, their units and resultants") {
  const SyntheticOptions loaded{.levels = 2, .gravity = true, .pressures = 1};
  const auto json = nlohmann::json::parse(inspected(loaded, true));
  CHECK(json["version"] == "4.6");
  const auto& loads = json["loads"];
  REQUIRE(loads.size() == 4);
  CHECK(loads[2]["name"] == "acceleration along z");
  CHECK(loads[2]["unit"] == "m/s^2");
  CHECK(loads[2]["resultant"][0] == 0);
  CHECK(loads[2]["resultant"][2] > 0);
  CHECK(loads[3]["name"] == "pressure 0");
  CHECK(loads[3]["unit"] == "Pa");
  const std::string table = inspected(loaded, false);
  CHECK(table.find("\n  loads               acceleration along x (") != std::string::npos);
  CHECK(table.find(" N per m/s^2); pressure 0 (") != std::string::npos);
}

TEST_CASE("inspect: a model without loads has none") {
  CHECK(nlohmann::json::parse(inspected({.levels = 2}, true))["loads"].empty());
  CHECK(inspected({.levels = 2}, false).find("\n  loads               none\n") != std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
