#include "offline/pipeline/body_geometry.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/test_files.hpp"
#include "offline/pipeline/stage_records.hpp"
#include "offline/surface/test_surfaces.hpp"

namespace greenloop::offline {
namespace {

BodyGeometry geometry(const std::filesystem::path& folder, const std::string& of_surface) {
  const auto scene = parse_scene("[surface]\nfile = \"body.off\"\nunit = \"cm\"\n" + of_surface +
                                     "[remesh]\nlevels = 1\n"
                                     "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                                     "[[fixed]]\nbelow = 0.2\naxis = \"z\"\n",
                                 folder / "body.toml");
  ProgressBar quiet(true);
  return make_body_geometry(scene, quiet);
}

std::string refusal(const std::filesystem::path& folder, const std::string& of_surface) {
  try {
    static_cast<void>(geometry(folder, of_surface));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("a surface that does not enclose one solid is refused with the way out, which is one") {
  const auto folder = scratch_folder("body_geometry_test");
  write_surface(folder / "body.off", together(cube(), cube({0.5, 0.5, 0.5})));
  const std::string refused = refusal(folder, "");
  CHECK(refused.find("several pieces: 2") != std::string::npos);
  CHECK(refused.find("set [surface] wrap = \"auto\"") != std::string::npos);

  const BodyGeometry body = geometry(folder, "wrap = \"0.05 cm\"\n");
  REQUIRE(body.report.wrap);
  CHECK(body.report.wrap->length == doctest::Approx(0.0005));
  CHECK(body.report.wrap->volume == doctest::Approx(1.875e-6).epsilon(1e-3));
  CHECK(body.report.wrap->to_original.greatest < 0.0005);
  CHECK(body.surface.positions.size() > 42);
  const auto record = geometry_record(body.report);
  CHECK(record["surface"]["wrap"]["length"] == body.report.wrap->length);
  CHECK(record["surface"]["wrap"]["volume_before"].get<double>() == doctest::Approx(2e-6));
  CHECK(record["surface"]["repairs"][0].get<std::string>().find("wrapped at 0.0005 m in ") == 0);
}

TEST_CASE("what a wrap refuses names the file and offers no other wrap") {
  const auto folder = scratch_folder("body_geometry_refusal_test");
  write_surface(folder / "body.off", together(cube(), cube({2, 0, 0})));
  const std::string refused = refusal(folder, "wrap = \"auto\"\n");
  CHECK(refused.find("body.off: wrap: 2 separate pieces") != std::string::npos);
  CHECK(refused.find("set [surface] wrap") == std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
