// gel_pad PAD.gloop [edge] MIDDLE RIM LAYERS [FOLDER]: presses a ball, a cylinder and an edge, or the edge alone, into
// a model of a tactile sensor's gel pad, as the loop does, and compares force and pressure with those of refined finite
// elements of so many cells under the same law of contact. gel_pad PAD.gloop edge FINE [FOLDER]: beside elements that
// are finer where the edge lets go. Draws maps of pressures and displacements into FOLDER. The pads:
// `write_body pad 2 pad.mesh` and `write_body edge_pad 2 edge_pad.mesh`, their scenes offline/scene/examples/pad.toml
// and edge_pad.toml.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "offline/report/mask_figure.hpp"
#include "offline/report/report.hpp"
#include "rt_tests/gel_pad/pressed_pad.hpp"
#include "rt_tests/gel_pad/refined_pad.hpp"

namespace greenloop::gel_pad {
namespace {

constexpr double reach = 4.1e-3;  // m, farther than any of the indenters touches
constexpr double shown = 5e-3;    // m, of the pictures, from the middle
constexpr int steps = 20;

// a piece of the upper side, finer than the crossings of a field
offline::VisibleSurface shown_side() {
  constexpr int across = 121;
  offline::VisibleSurface side;
  for (int j = 0; j < across; ++j) {
    for (int i = 0; i < across; ++i) {
      side.positions.emplace_back(shown * (2.0 * i / (across - 1) - 1), shown * (2.0 * j / (across - 1) - 1), 0);
      if (i == 0 || j == 0) continue;
      const int high = i + across * j, low = high - across - 1;
      side.triangles.push_back({low, low + 1, high});
      side.triangles.push_back({low, high, high - 1});
    }
  }
  side.fixed.assign(side.positions.size(), 0);
  return side;
}

offline::SvgCanvas map(const std::string& name, const char* unit, const SideField& field) {
  const offline::VisibleSurface side = shown_side();
  std::vector<double> value;
  for (const Eigen::Vector3d& place : side.positions) {
    value.push_back(std::max(0.0, field.at(place.x(), place.y())));
  }
  const double most = *std::max_element(value.begin(), value.end());
  for (double& one : value) one = one < 0.01 * most ? 0 : one;
  return offline::value_panel(side, offline::view_frame({0, 0, 1}, {0, 1, 0}), name, unit, value);
}

constexpr const char* usage =
    "usage: gel_pad PAD.gloop [edge] MIDDLE RIM LAYERS [FOLDER]\n"
    "       gel_pad PAD.gloop edge FINE [FOLDER]\n\n"
    "Presses a ball, a cylinder and an edge, or the edge alone, into a model of a gel pad, and compares force and\n"
    "pressure with those of refined finite elements: MIDDLE cells across its middle, RIM beside it on each side, "
    "LAYERS\n"
    "in its thickness, 1 to 1000; or the cells of `write_body edge_pad` with 1/FINE of their size. Maps of pressures "
    "and\n"
    "displacements go into FOLDER.\n";

int cells_of(const char* text) {
  constexpr int most = 1000;
  char* end = nullptr;
  const long cells = std::strtol(text, &end, 10);
  if (*end != 0 || cells < 1 || cells > most)
    throw std::runtime_error(std::string(text) + ": 1 to 1000 cells\n" + usage);
  return static_cast<int>(cells);
}

struct Comparison {
  const char* model;
  offline::testing::Planes cells;  // of the refined elements
  std::vector<Indenter> pressed;
  const char* folder;
};

Comparison comparison(int count, char** argument) {
  const char* const model = argument[1];
  const bool is_edge = std::string_view(argument[2]) == "edge";
  char** const cells = argument + (is_edge ? 3 : 2);
  const auto given = count - (cells - argument);  // cells and folder
  if (given > 4 || given < 1 || (!is_edge && given < 3)) throw std::runtime_error(usage);
  const std::vector<Indenter> pressed = is_edge ? std::vector{indenters().back()} : indenters();
  if (given < 3)
    return {model, offline::testing::edge_pad(cells_of(cells[0])), pressed, given == 2 ? cells[1] : nullptr};
  return {model, offline::testing::gel_pad(cells_of(cells[0]), cells_of(cells[1]), cells_of(cells[2])), pressed,
          given == 4 ? cells[3] : nullptr};
}

void run(const Comparison& of) {
  const ModelFile file = open_model_file(of.model);
  const Model model = Model::open(file.bytes.span()).model;
  const RefinedPad refined(quarter(of.cells), {file.view.info->young, file.view.info->poisson}, reach);
  offline::Figure figure{"gel_pad", "A gel pad under indenters", "", {}, 3};
  for (const Indenter& indenter : of.pressed) {
    const PressedPad found = press_in_loop(model, indenter, steps);
    const Pressed expected = refined.press(indenter.shape, indenter.at(indenter.depth));
    const Difference off = difference(found, expected);
    std::printf(
        "%-8s %.2f mm deep: %.4f N on %u places (last change %.1e), refined %.4f N; "
        "force %+.2f %%, pressure %.2f %% RMS\n",
        indenter.name.data(), 1e3 * indenter.depth, found.force, found.contacts, found.settled, expected.force,
        100 * off.force, 100 * off.pressure);
    const std::string name(indenter.name);
    figure.panels.push_back(map(name + ", pressure", "Pa", found.pressure));
    figure.panels.push_back(map(name + ", refined", "Pa", expected.pressure));
    figure.panels.push_back(map(name + ", depression", "m", found.down));
  }
  if (of.folder != nullptr) offline::write_figures(of.folder, {figure});
}

}  // namespace
}  // namespace greenloop::gel_pad

int main(int count, char** argument) {
  if (count == 2 && std::string_view(argument[1]) == "--help") return std::fputs(greenloop::gel_pad::usage, stdout) < 0;
  if (count < 4) {
    std::fputs(greenloop::gel_pad::usage, stderr);
    return 2;
  }
  try {
    greenloop::gel_pad::run(greenloop::gel_pad::comparison(count, argument));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gel_pad: %s\n", error.what());
    return 1;
  }
  return 0;
}
