#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <fstream>

#include "formats/mesh/volume_io.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/write/model_file.hpp"
#include "offline/pipeline/build_model_file.hpp"
#include "rt_tests/gel_pad/pressed_pad.hpp"
#include "rt_tests/gel_pad/refined_pad.hpp"

namespace greenloop::gel_pad {
namespace {

using offline::testing::Planes;

// the model of a pad of few cells
ModelFile built(const TemporaryFolder& folder, const Planes& planes) {
  write_volume(folder.path() / "pad.mesh", offline::testing::box(planes));
  std::ofstream(folder.path() / "pad.toml")
      << "[volume]\nfile = \"pad.mesh\"\nunit = \"m\"\n[remesh]\nlevels = 1\n"
         "[material]\nyoung = \"100 kPa\"\npoisson = 0.45\n[solve]\nelements = \"quadratic\"\n"
         "[[fixed]]\nbelow = 0\naxis = \"z\"\n[[touched]]\nbox = [[0.25, 0.25, 1], [0.75, 0.75, 1]]\n"
         "[[read]]\nbox = [[0.25, 0.25, 1], [0.75, 0.75, 1]]\n"
         "[accuracy]\nrms = 0.003\npatch_force = 0.01\n[compression]\nwavelet = \"equilibrated\"\n"
         "[budget]\ncontacts = 256\n";
  offline::ProgressBar quiet(true);
  (void)offline::build_model_file(
      {.scene = folder.path() / "pad.toml", .model = folder.path() / "pad.gloop", .store = {}}, quiet);
  return open_model_file(folder.path() / "pad.gloop");
}

TEST_CASE("the loop presses a gel pad as a plain iteration on the same elements does") {
  const Planes planes = offline::testing::gel_pad(12, 2, 2);
  const TemporaryFolder folder("gel_pad_test");
  const ModelFile file = built(folder, planes);
  const Model model = Model::open(file.bytes.span()).model;
  const RefinedPad same(planes, {1e5, 0.45}, 4.1e-3);
  for (const Indenter& indenter : indenters()) {
    if (indenter.name == "edge") continue;  // thinner than two cells, where the loop looks at the tool's own points too
    const PressedPad found = press_in_loop(model, indenter, 8);
    const Difference of = difference(found, same.press(indenter.shape, indenter.at(indenter.depth)));
    MESSAGE(indenter.name, ": ", found.force, " N on ", found.contacts, " places; force ", 100 * of.force,
            " %, pressure ", 100 * of.pressure, " % RMS");
    CHECK(found.contacts > 8);
    CHECK(std::abs(of.force) < 0.003);
    CHECK(of.pressure < 0.005);
    CHECK(found.pressure.value.dot(crossing_areas(found.pressure.planes)) == doctest::Approx(found.force));
  }
}

TEST_CASE("a quarter of a pad is pressed as the whole is, but for the way its cells are cut") {
  const Planes planes = offline::testing::gel_pad(8, 1, 1);
  const RefinedPad whole(planes, {1e5, 0.3}, 4.1e-3), part(quarter(planes), {1e5, 0.3}, 4.1e-3);
  const Indenter ball = indenters()[0];
  const Difference of = difference(part.press(ball.shape, ball.at(1e-3)), whole.press(ball.shape, ball.at(1e-3)));
  MESSAGE("force ", 100 * of.force, " %, pressure ", 100 * of.pressure, " % RMS");
  CHECK(std::abs(of.force) < 0.03);
  CHECK(of.pressure < 0.1);
}

TEST_CASE("a field between crossings is linear in triangles, and its areas integrate it") {
  SideField field{{{{-3, -1, 0, 2}, {-3, -1, 0, 2}}}, Eigen::VectorXd(16)};
  for (int i = 0; i < 16; ++i) field.value[i] = 1 + 2 * field.planes[0][i % 4] - 3 * field.planes[1][i / 4];
  CHECK(field.at(-2, 0.5) == doctest::Approx(-4.5));
  CHECK(field.at(1.9, 1) == doctest::Approx(1.8));
  CHECK(field.at(2, -3) == doctest::Approx(14));
  CHECK(field.at(2.1, 0) == 0);
  CHECK(field.at(0, -3.1) == 0);
  CHECK(field.value.dot(crossing_areas(field.planes)) == doctest::Approx(25 * (1 + 2 * -0.5 - 3 * -0.5)));
  field.value.setZero();
  field.value[5] = 1;  // whose cell's triangles meet in (-1, -1) and (0, 0)
  CHECK(field.at(-0.25, -0.75) == doctest::Approx(0.25));
  CHECK(field.at(-0.75, -0.25) == doctest::Approx(0.25));
}

}  // namespace
}  // namespace greenloop::gel_pad
