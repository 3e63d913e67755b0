// inspect, verify and convert on a scalar model: what they say of vectors and materials is not said of it.

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/write/model_file.hpp"
#include "offline/cli/convert_command.hpp"
#include "offline/cli/inspect_command.hpp"
#include "offline/cli/verify_command.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::json;

class ScalarFile {
 public:
  ScalarFile() {
    ModelData model = synthetic_model({.components = 1, .levels = 3});
    model.info.lambda_min = 2.5e-5;
    write_file(path(), encode(model));
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "scalar.gloop"; }
  [[nodiscard]] std::filesystem::path beside(const std::string& name) const { return folder_.path() / name; }

 private:
  TemporaryFolder folder_{"scalar_model_test"};
};

std::string inspected(const std::filesystem::path& file, bool json) {
  std::ostringstream out;
  CHECK(run_inspect({file, json}, out) == 0);
  return out.str();
}

TEST_CASE("inspect --json: a scalar model says so; what it has not is null under its key") {
  const ScalarFile file;
  const Json found = Json::parse(inspected(file.path(), true));
  CHECK(found["problem"] == "scalar");
  CHECK(found["version"] == "4.3");
  CHECK(found["domain_nodes"] == 41);
  CHECK(found["dense_bytes"] == 4 * 41 * 41);
  CHECK(found["kept_blocks"] > 41);
  for (const char* key : {"material", "field_blocks", "longest_field_column"}) {
    CAPTURE(key);
    REQUIRE(found.contains(key));
    CHECK(found[key].is_null());
  }
  for (const char* unit : {"force", "compliance", "young"}) CHECK(found["units"].at(unit).is_null());
  CHECK(found["units"]["length"] == "m");
  CHECK(found["budget"]["rate"] == 1000);
  CHECK(found["budget"]["work"] == 1000000);
  for (const char* key : {"us", "least_work", "arena_bytes", "create_ms"}) CHECK(found["budget"].at(key).is_null());
}

TEST_CASE("inspect: an elastostatic model is said to be one, under the keys that a scalar one has") {
  const ScalarFile scalar;
  write_file(scalar.beside("sphere.gloop"), encode(synthetic_model({.levels = 3})));
  const Json vectors = Json::parse(inspected(scalar.beside("sphere.gloop"), true));
  CHECK(vectors["problem"] == "elastostatic");
  CHECK(inspected(scalar.beside("sphere.gloop"), false).find("problem             elastostatic\n") !=
        std::string::npos);
  const Json numbers = Json::parse(inspected(scalar.path(), true));
  for (const auto& [key, value] : vectors.items()) CHECK(numbers.contains(key));
  CHECK(numbers.size() == vectors.size());
}

TEST_CASE("inspect: the table of a scalar model has no material and no unit of its quantity") {
  const ScalarFile file;
  const std::string text = inspected(file.path(), false);
  CHECK(text.find("problem             scalar\n") != std::string::npos);
  CHECK(text.find("above 2.5e-05 (verify --certificate)") != std::string::npos);
  for (const char* word : {"Young", "Poisson", "m/N", "null"}) {
    CAPTURE(word);
    CHECK(text.find(word) == std::string::npos);
  }
}

TEST_CASE("verify: a scalar model is valid; its certificate is not proven, and why is said") {
  const ScalarFile file;
  std::ostringstream valid, certified;
  CHECK(run_verify({.file = file.path(), .certificate = false, .json = false}, valid) == 0);
  CHECK(valid.str() == file.path().string() + ": the file is valid\n");
  CHECK(run_verify({.file = file.path(), .certificate = true, .json = true}, certified) == 1);
  const Json verdict = Json::parse(certified.str());
  CHECK(verdict["ok"] == false);
  CHECK(verdict["certificate"]["holds"] == false);
  CHECK(verdict["message"] ==
        file.path().string() + ": this is a scalar model; only the certificate of an elastostatic one can be checked");
}

TEST_CASE("convert: a scalar model becomes its transport form and comes back, cut or as a surface") {
  const ScalarFile file;
  std::ostringstream out;
  const auto convert = [&](const std::string& from, const std::string& to, std::optional<std::uint32_t> levels) {
    CHECK(run_convert({.input = file.beside(from), .output = file.beside(to), .levels = levels}, out) == 0);
  };
  convert("scalar.gloop", "scalar.gloopz", {});
  convert("scalar.gloopz", "back.gloop", {});
  convert("scalar.gloopz", "coarse.gloop", 2);
  convert("scalar.gloop", "surface.obj", {});
  const ModelFile whole = open_model_file(file.path()), back = open_model_file(file.beside("back.gloop"));
  CHECK(std::ranges::equal(whole.bytes.span(), back.bytes.span()));
  const ModelFile coarse = open_model_file(file.beside("coarse.gloop"));
  CHECK(coarse.view.problem == layout::Problem::scalar);
  CHECK(coarse.view.levels == 2);
}

}  // namespace
}  // namespace greenloop::offline
