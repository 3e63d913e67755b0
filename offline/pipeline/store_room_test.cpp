#include "offline/pipeline/store_room.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/mesh/surface_io.hpp"
#include "offline/pipeline/build_model_file.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

template <class Attempt>
std::string refusal(const Attempt& attempt) {
  try {
    attempt();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

void check_says(const std::string& message, const std::vector<std::string>& parts) {
  CAPTURE(message);
  for (const std::string& part : parts) {
    CAPTURE(part);
    CHECK(message.find(part) != std::string::npos);
  }
}

TEST_CASE("store room: as much as the columns take, or a refusal with file, sizes and remedies") {
  const auto file = std::filesystem::temp_directory_path() / "greenloop_room.h5";
  CHECK_NOTHROW(require_store_room(file, 100, 100));
  CHECK_NOTHROW(require_store_room(file, 1'000'000'000, 0));  // all solved
  check_says(refusal([&] { require_store_room(file, 1'000'000'000, 1'000'000); }),
             {file.string(), "1000000 columns", "72000000.0 GB", "GB free", "--store", "levels"});
  CHECK_NOTHROW(require_store_room("no/such/folder/greenloop_room.h5", 1'000'000'000, 1'000'000));
}

// /proc has room for nothing
TEST_CASE("store room: a build whose store does not fit ends before its body is filled") {
  const auto folder =
      std::filesystem::temp_directory_path() / ("greenloop_store_room_test_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const SemiRegularMesh ball = testing::ellipsoid(2, {1, 1, 1});
  write_surface(folder / "ball.off", {ball.positions, triangles_of_level(ball, 2)});
  std::ofstream(folder / "ball.toml") << "[surface]\nfile = \"ball.off\"\nsize = \"10 cm\"\n"
                                         "[remesh]\nbase_vertices = 12\nlevels = 2\n"
                                         "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                                         "[[fixed]]\nbelow = 0.2\naxis = \"z\"\n";
  ProgressBar progress(true);
  const BuildRequest request{
      .scene = folder / "ball.toml", .model = folder / "ball.gloop", .store = "/proc/greenloop_room.h5"};
  check_says(refusal([&] { build_model_file(request, progress); }),
             {"/proc/greenloop_room.h5", " columns of Green's functions to solve need ", "0.0 kB free", "--store"});
  const auto& stages = progress.stages();
  CHECK(std::any_of(stages.begin(), stages.end(), [](const FinishedStage& stage) { return stage.name == "remesh"; }));
  CHECK(std::none_of(stages.begin(), stages.end(),
                     [](const FinishedStage& stage) { return stage.name == "tetrahedra" || stage.name == "solve"; }));
  CHECK_FALSE(std::filesystem::exists(request.model));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace greenloop::offline
