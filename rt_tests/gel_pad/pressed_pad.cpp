#include "rt_tests/gel_pad/pressed_pad.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/contact_body.hpp"

namespace greenloop::gel_pad {
namespace {

constexpr std::uint32_t elsewhere = layout::none;  // of a node that is not on the upper side

// the planes between whose crossings the nodes of the upper side lie, and each node's crossing
struct Grid {
  SidePlanes planes;
  std::vector<std::uint32_t> crossing;
};

const float* place_of(const ModelView& view, std::uint32_t node) {
  std::uint32_t level = 0;
  while (node - view.level[level].node_begin >= view.level[level].counts->node_count) ++level;
  return view.level[level].nodes[node - view.level[level].node_begin].position;
}

Grid upper_grid(const ModelView& view) {
  constexpr double same = 1e-7;  // m
  Grid grid;
  grid.crossing.assign(view.node_count, elsewhere);
  std::vector<std::uint32_t> upper;
  for (std::uint32_t node = 0; node < view.node_count; ++node) {
    if (double{place_of(view, node)[2]} < thickness - same) continue;
    upper.push_back(node);
    for (std::size_t axis = 0; axis < 2; ++axis) grid.planes[axis].push_back(double{place_of(view, node)[axis]});
  }
  for (std::vector<double>& planes : grid.planes) {
    std::sort(planes.begin(), planes.end());
    const auto last = std::unique(planes.begin(), planes.end(), [](double a, double b) { return b - a < same; });
    planes.erase(last, planes.end());
  }
  const auto& [across, along] = grid.planes;
  if (across.size() < 2 || along.size() < 2 || across.size() * along.size() != upper.size()) {
    throw std::runtime_error("the nodes of the pad's upper side are no grid: " + std::to_string(upper.size()));
  }
  const auto plane = [](const std::vector<double>& planes, float x) {
    const auto at = std::lower_bound(planes.begin(), planes.end(), double{x} - same);
    return static_cast<std::uint32_t>(at - planes.begin());
  };
  for (const std::uint32_t node : upper) {
    const float* place = place_of(view, node);
    grid.crossing[node] = plane(across, place[0]) + static_cast<std::uint32_t>(across.size()) * plane(along, place[1]);
  }
  return grid;
}

double smallest_edge(const Grid& grid) {
  double smallest = grid.planes[0][1] - grid.planes[0][0];
  for (const std::vector<double>& planes : grid.planes) {
    for (std::size_t i = 1; i < planes.size(); ++i) smallest = std::min(smallest, planes[i] - planes[i - 1]);
  }
  return smallest;
}

void read_answer(const Grid& grid, const ContactBody& body, PressedPad& pressed) {
  const Eigen::VectorXd area = crossing_areas(grid.planes);
  pressed.pressure = pressed.down = {grid.planes, Eigen::VectorXd::Zero(area.size())};
  for (const ContactBody::Contact& contact : body.contacts()) {
    if (contact.force.z == 0) continue;
    ++pressed.contacts;
    for (int k = 0; k < 3 && contact.node[k] != layout::none; ++k) {
      const std::uint32_t at = grid.crossing[contact.node[k]];
      if (at == elsewhere) throw std::runtime_error("the pad is touched beside its upper side");
      pressed.pressure.value[at] -= contact.weight[k] * contact.force.z / area[at];
    }
  }
  for (std::size_t node = 0; node < grid.crossing.size(); ++node) {
    if (grid.crossing[node] != elsewhere) {
      pressed.down.value[grid.crossing[node]] = -double{body.displacement()[node].z};
    }
  }
}

}  // namespace

PressedPad press_in_loop(const Model& model, const Indenter& indenter, int steps) {
  const Grid grid = upper_grid(model.view());
  ContactBody::Limits limits;
  limits.elastostatic = {.max_contacts = 256, .cached_factors = 2, .iterations = 100};
  limits.max_tools = 1;
  limits.margin = smallest_edge(grid) / 7;  // that there is room for what touches
  limits.search_work = 20'000'000;          // all that is asked for
  const auto need = ContactBody::required(model, limits);
  AlignedBytes memory(need.bytes);
  auto created = ContactBody::create(model, limits, {memory.data(), memory.size()});
  if (!created) throw std::runtime_error("the model carries no tools");
  PressedPad pressed;
  for (int step = -1; step < 2 * steps; ++step) {
    const double deep = indenter.depth * std::min(1.0, (step + 0.5) / (steps - 0.5));
    const ContactBody::ToolInput tool{{indenter.shape, indenter.at(deep)}, 0};
    const auto report = created.body.step({&tool, 1}, {}, {need.worst_work});
    if (!answered(report.status)) throw std::runtime_error("a step was not answered");
    if (report.left_out + report.unfinished > 0)
      throw std::runtime_error("there was no room for what touches: " + std::to_string(report.left_out) +
                               " places left out, " + std::to_string(report.unfinished) +
                               " tools not looked at as a whole");
    const double force = created.body.tools()[0].force.z;
    pressed.settled = std::abs(force - pressed.force) / force;
    pressed.force = force;
  }
  read_answer(grid, created.body, pressed);
  return pressed;
}

}  // namespace greenloop::gel_pad
