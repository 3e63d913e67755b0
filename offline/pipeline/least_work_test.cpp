// What a body needs at least is known before its columns are: never more than what its model declares.

#include "offline/pipeline/least_work.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/write/model_file.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/compress/testing/test_body.hpp"
#include "offline/pipeline/build_model_file.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

constexpr std::uint32_t contacts = 9;

TEST_CASE("the bound before anything is computed is below what models of every wavelet declare") {
  const test::Body body = test::make_body(3);
  const std::uint64_t bound = least_work_bound(body.mesh, body.flags, body.area, contacts, 0);
  CHECK(bound > 0);
  CHECK(least_work_bound(body.mesh, body.flags, body.area, 2 * contacts, 0) > bound);
  CHECK(least_work_bound(body.mesh, body.flags, body.area, contacts, 1) > bound);
  for (const layout::Wavelet wavelet : layout::wavelets) {
    ModelData model = test::model_of<3>(body, wavelet, {.threshold = 0.01, .quantum = 0.001});
    model.info.max_contacts = contacts;
    CAPTURE(static_cast<int>(wavelet));
    CHECK(least_work(encode(model)) >= bound);
  }
}

Scene scene_with(const std::string& budget) {
  return parse_scene(
      "[surface]\nfile = \"bear.off\"\nunit = \"cm\"\n[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
      "[[fixed]]\nbelow = 0.1\naxis = \"y\"\n[budget]\n" +
          budget,
      "bear.toml");
}

std::string refusal(const std::string& budget, std::uint64_t least, LeastOf models = LeastOf::any_wavelet) {
  try {
    require_work(scene_with(budget), "bear.toml", least, models);
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

TEST_CASE("a budget that cannot hold the least answer is refused by file, key, value and what mends it") {
  CHECK(refusal("work = 999\n", 1000) ==
        "bear.toml: budget.work: 999 units a step; 16 contacts need at least 1000, at the coarsest level; raise work "
        "or lower contacts");
  CHECK(refusal("work = 999\n", 1000, LeastOf::this_wavelet) ==
        refusal("work = 999\n", 1000) + "; another [compression] wavelet may need less");
  CHECK(refusal("rate = \"4 kHz\"\nshare = 0.4\nunits_per_us = 2000\ncontacts = 5\n", 200001) ==
        "bear.toml: budget.share: 0.4 of a period of 4000 Hz is 100 us, 200000 work units at 2000 units per us; 5 "
        "contacts need at least 200001, at the coarsest level; raise share, lower rate or contacts, or state with "
        "units_per_us how much faster the target is");
}

TEST_CASE("a budget that holds the least answer is not refused, nor where the build chooses") {
  CHECK(refusal("work = 1000\n", 1000).empty());
  CHECK(refusal("rate = \"4 kHz\"\nshare = 0.4\nunits_per_us = 2000\n", 200000).empty());
  CHECK(refusal("rate = \"1 MHz\"\n", std::uint64_t{1} << 50).empty());
}

// A ball of 42 nodes in a folder of its own, built with one budget after the other.
class BallBuild {
 public:
  BallBuild() {
    const SemiRegularMesh ball = testing::ellipsoid(1, {1, 1, 1});
    write_surface(folder_.path() / "ball.off", {ball.positions, triangles_of_level(ball, 1)});
  }

  // what a build with these keys of [budget] says, if it is refused
  std::string refusal(const std::string& budget) {
    std::ofstream(folder_.path() / "ball.toml") << "[surface]\nfile = \"ball.off\"\nsize = \"10 cm\"\n"
                                                   "[remesh]\nbase_vertices = 12\nlevels = 1\n"
                                                   "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                                                   "[[fixed]]\nbelow = 0.2\naxis = \"z\"\n"
                                                   "[compression]\nwavelet = \"linear\"\n[budget]\n"
                                                << budget;
    progress_ = ProgressBar(true);
    try {
      build_model_file({.scene = folder_.path() / "ball.toml", .model = model(), .store = store()}, progress_);
    } catch (const SceneError& error) {
      return error.what();
    }
    return {};
  }

  [[nodiscard]] bool went_through(const std::string& stage) const {
    return std::any_of(progress_.stages().begin(), progress_.stages().end(),
                       [&](const FinishedStage& finished) { return finished.name == stage; });
  }
  [[nodiscard]] std::filesystem::path model() const { return folder_.path() / "ball.gloop"; }
  [[nodiscard]] std::filesystem::path store() const { return folder_.path() / "ball.h5"; }

 private:
  TemporaryFolder folder_{"least_work_test"};
  ProgressBar progress_{true};
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_CASE("an impossible budget is told how many contacts would do") {
  const SemiRegularMesh ball = testing::ellipsoid(1, {1, 1, 1});
  const std::vector<std::uint32_t> flags(ball.positions.size(), layout::node_domain | layout::node_touchable);
  const std::vector<double> area(ball.positions.size(), 1.0);
  const auto least = [&](std::uint32_t nodes) { return least_work_bound(ball, flags, area, nodes, 0); };
  REQUIRE(least(5) > least(4));
  StepBudget budget;
  budget.work = static_cast<std::int64_t>(least(4));
  CHECK(contains(what_would_do(budget, ball, flags, area, 0), "contacts = 4 would do"));
  budget.work = 1;
  CHECK(what_would_do(budget, ball, flags, area, 0) ==
        "not even a single contact would fit, on whatever remesh.levels");
}

TEST_CASE("a build refuses a budget before it solves, or else before it writes, and keeps what it solved") {
  BallBuild ball;
  CHECK(contains(ball.refusal("work = 1\n"), "ball.toml: budget.work: 1 units a step; 16 contacts need at least "));
  CHECK_FALSE(ball.went_through("tetrahedra"));
  CHECK_FALSE(std::filesystem::exists(ball.store()));

  REQUIRE(ball.refusal("rate = \"4 kHz\"\n").empty());
  const std::uint64_t least = least_work(open_model_file(ball.model()).bytes.span());
  std::filesystem::remove(ball.model());
  const std::string late = ball.refusal("work = " + std::to_string(least - 1) + "\n");
  CHECK(contains(late, "16 contacts need at least " + std::to_string(least) + ", at the coarsest level"));
  CHECK(contains(late, "another [compression] wavelet may need less"));
  CHECK(ball.went_through("compress"));
  CHECK_FALSE(std::filesystem::exists(ball.model()));
  CHECK(std::filesystem::exists(ball.store()));

  CHECK(ball.refusal("rate = \"4 kHz\"\nshare = 0.5\nunits_per_us = " + std::to_string(least) + "\n").empty());
  CHECK_FALSE(ball.went_through("tetrahedra"));
  const ModelFile built = open_model_file(ball.model());
  CHECK(built.view.info->step_work == 125 * least);
  CHECK(built.view.info->share == 0.5F);
  CHECK(built.view.header->minor == 5);
}

}  // namespace
}  // namespace greenloop::offline
