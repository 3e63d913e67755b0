// What inspect says of what was asked of a model, and of what it was made from.

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

using Json = nlohmann::json;

// a model with this provenance
class Inspected {
 public:
  explicit Inspected(const std::string& provenance) {
    ModelData data = synthetic_model({.levels = 3});
    for (LevelData& level : data.levels) level.counts.patch_force_error = 0.25;
    data.provenance = provenance;
    write_file(file_, encode(data));
  }

  [[nodiscard]] std::string text(bool provenance = false) const {
    std::ostringstream out;
    CHECK(run_inspect({.file = file_, .provenance = provenance}, out) == 0);
    return out.str();
  }
  [[nodiscard]] Json json() const {
    std::ostringstream out;
    CHECK(run_inspect({.file = file_, .json = true}, out) == 0);
    return Json::parse(out.str());
  }

 private:
  TemporaryFolder folder_{"inspect_quality_test"};
  std::filesystem::path file_ = folder_.path() / "own.gloop";
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// of a scene that asks for this of patches and, in lines of its own, of the mesh
std::string provenance(double patch_force, double mesh_error, const std::string& asked_of_mesh = "") {
  const std::string scene =
      "[surface]\nfile = \"own.off\"\nunit = \"m\"\n[material]\nyoung = \"1 Pa\"\npoisson = 0.4\n[[fixed]]\n"
      "below = 0.1\naxis = \"z\"\n[accuracy]\nrms = 0.9\npatch_force = " +
      std::to_string(patch_force) + "\n" + asked_of_mesh;
  return Json{{"scene_text", scene}, {"mesh_error", {{"force", mesh_error}}}}.dump();
}

TEST_CASE("inspect: provenance is printed if it is asked for") {
  const Inspected model(R"({"generator": "by hand"})");
  CHECK_FALSE(contains(model.text(), "by hand"));
  CHECK(contains(model.text(true), "\"generator\": \"by hand\""));
  CHECK(model.json()["provenance"]["generator"] == "by hand");
}

TEST_CASE("inspect: a model whose scene is not known is not judged") {
  const Json found = Inspected("{}").json();
  CHECK(found["verdict"] == "NOT JUDGED");
  CHECK(found["quality"]["compression_error"]["rms"]["asked"].is_null());
  CHECK(found["quality"]["compression_error"]["rms"]["reached"] == found["rms_error"]);
  CHECK(found["quality"]["mesh_error"]["reached"].is_null());
}

TEST_CASE("inspect: errors are judged by what the scene asks for, mesh and compression apart") {
  CHECK(Inspected(provenance(0.5, 0.6, "mesh_error = 0.7\n")).json()["verdict"] == "HELD");
  {
    const Inspected model(provenance(0.5, 0.4, "mesh_error = 0.3\n"));
    CHECK(model.json()["verdict"] == "VIOLATED");
    CHECK(model.json()["quality"]["warning"].is_null());
    CHECK(contains(model.text(), "VIOLATED: the mesh error is 40 % where 30 % is asked; all other errors are within"));
  }
  const Inspected model(provenance(0.2, 0.1, "mesh_error = 0.2\n"));
  CHECK(model.json()["verdict"] == "VIOLATED");
  CHECK(contains(model.text(), "VIOLATED: the compression error (patch_force) is 25 % where 20 % is asked; all other"));
  CHECK(model.json()["quality"]["mesh_error"] == Json{{"asked", 0.2}, {"reached", 0.1}, {"held", true}});
}

TEST_CASE(
    "inspect: a mesh error of which nothing is asked is no violation; beyond what is asked of forces it is warned of") {
  const Inspected small(provenance(0.5, 0.4));
  CHECK(small.json()["verdict"] == "HELD");
  CHECK(small.json()["quality"]["warning"].is_null());
  CHECK(small.json()["quality"]["mesh_error"] == Json{{"asked", nullptr}, {"reached", 0.4}, {"held", nullptr}});
  const Inspected large(provenance(0.5, 0.6));
  CHECK(large.json()["verdict"] == "HELD");
  CHECK(contains(large.json()["quality"]["warning"].get<std::string>(), "up to 60 % too large"));
  CHECK(contains(large.text(), "HELD: all errors are within what is asked; warning: the tetrahedra make forces"));
}

}  // namespace
}  // namespace greenloop::offline
