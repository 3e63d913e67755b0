#include "formats/write/model_file.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/write/describe.hpp"

namespace greenloop {
namespace {

// an empty folder that goes away with the test
class Scratch {
 public:
  explicit Scratch(const std::string& name) : folder_(std::filesystem::temp_directory_path() / ("greenloop_" + name)) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

template <class Call>
std::string failure(Call call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("model file: written, it loads aligned and verified") {
  const Scratch scratch("model_file_load");
  const auto path = scratch / "sphere.gloop";
  const auto bytes = encode(synthetic_model({.levels = 2}));
  write_file(path, bytes);
  const ModelFile model = open_model_file(path);
  CHECK(model.bytes.size() == bytes.size());
  CHECK(reinterpret_cast<std::uintptr_t>(model.bytes.data()) % layout::alignment == 0);
  CHECK(model.view.levels == 2);
}

TEST_CASE("model file: a model of another problem than is taken is refused by name; one of it passes") {
  const ModelFile scalar = encoded_file(synthetic_model({.components = 1, .levels = 1}));
  require_problem(scalar.view, layout::Problem::scalar, "warm.gloop");
  CHECK(failure([&] { require_problem(scalar.view, layout::Problem::elastostatic, "warm.gloop"); }) ==
        "warm.gloop: this is a scalar model; only elastostatic ones are taken here");
}

TEST_CASE("model file: encoded, it stands as written, with its view") {
  const ModelData data = synthetic_model({.levels = 2});
  const ModelFile model = encoded_file(data);
  const auto bytes = encode(data);
  const auto found = model.bytes.span();
  CHECK(std::equal(found.begin(), found.end(), bytes.begin(), bytes.end()));
  CHECK(static_cast<const void*>(model.view.header) == model.bytes.data());
  CHECK(model.view.levels == 2);
}

TEST_CASE("model file: writing replaces the old file whole and leaves nothing beside it") {
  const Scratch scratch("model_file_replace");
  const auto path = scratch / "sphere.gloop";
  write_file(path, encode(synthetic_model({.levels = 3})));
  const auto bytes = encode(synthetic_model({.levels = 1}));
  write_file(path, bytes);
  CHECK(load_file(path).size() == bytes.size());
  CHECK(std::distance(std::filesystem::directory_iterator(path.parent_path()), {}) == 1);
}

TEST_CASE("model file: failures name the file") {
  const Scratch scratch("model_file_failures");
  const auto absent = (scratch / "absent.gloop").string();
  CHECK(failure([&] { (void)load_file(absent); }).find(absent + ": cannot be read: No such file") == 0);
  const auto nowhere = (scratch / "no_folder/x.gloop").string();
  CHECK(failure([&] { write_file(nowhere, {}); }).find(nowhere + ": cannot be written: No such file") == 0);
  const auto wrong = (scratch / "wrong.gloop").string();
  write_file(wrong, std::vector<std::byte>(640, std::byte{'x'}));
  const std::string message = failure([&] { (void)open_model_file(wrong); });
  CHECK(message.find(wrong + ": the header, field `magic`, index 0: this is not a model file") == 0);
  CHECK(message.find("name a .gloop file") != std::string::npos);
  const auto empty = (scratch / "empty.gloop").string();
  write_file(empty, {});
  CHECK(failure([&] { (void)open_model_file(empty); }).find("shorter than a header") != std::string::npos);
}

TEST_CASE("describe: every rule has a name and says how to mend the file") {
  for (int i = 1; i <= static_cast<int>(VerifyRule::inconsistent); ++i) {
    VerifyResult result;
    result.rule = static_cast<VerifyRule>(i);
    CAPTURE(i);
    CHECK(rule_name(result.rule) != "ok");
    CHECK(describe(result).find("; ") != std::string::npos);
    for (int j = 0; j < i; ++j) CHECK(rule_name(static_cast<VerifyRule>(j)) != rule_name(result.rule));
  }
  CHECK(describe({}) == "the file is valid");
}

}  // namespace
}  // namespace greenloop
