#include "offline/simulate/sheet_contacts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "offline/simulate/closest_on_triangle.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

// in thicknesses
constexpr double near_as_sewn = 2.5, search_radius = 1.5;

Vector3d at(const Places& places, const std::array<int, 3>& t, const Vector3d& weights) {
  return weights[0] * places[t[0]] + weights[1] * places[t[1]] + weights[2] * places[t[2]];
}

Vector3d normal_of(const Places& places, const std::array<int, 3>& t) {
  return (places[t[1]] - places[t[0]]).cross(places[t[2]] - places[t[0]]);
}

Vector3d closest(const Places& places, int vertex, const std::array<int, 3>& t) {
  return closest_on_triangle(places[vertex], places[t[0]], places[t[1]], places[t[2]]);
}

/// Cells of a grid in a table of a power of two.
struct Grid {
  double size;
  std::size_t mask;

  [[nodiscard]] Vector3i cell(const Vector3d& p) const { return (p / size).array().floor().cast<int>(); }
  [[nodiscard]] std::size_t slot(const Vector3i& c) const {
    const auto mixed = static_cast<std::uint32_t>(c.x()) * 73856093U ^ static_cast<std::uint32_t>(c.y()) * 19349663U ^
                       static_cast<std::uint32_t>(c.z()) * 83492791U;
    return mixed & mask;
  }
};

std::size_t table_size(std::size_t vertices) {
  std::size_t size = 64;
  while (size < 2 * vertices) size *= 2;
  return size;
}

double longest_side(const TriangleMesh& mesh) {
  double longest = 0;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      longest = std::max(longest, (mesh.vertices[t[i]] - mesh.vertices[t[(i + 1) % 3]]).norm());
    }
  }
  return longest;
}

}  // namespace

SheetContacts::SheetContacts(const TriangleMesh& sewn, double thickness, double friction,
                             const std::vector<double>& masses)
    : sewn_(sewn), thickness_(thickness), friction_(friction) {
  for (const double mass : masses) mobilities_.push_back(mass > 0 ? 1 / mass : 0);
}

bool SheetContacts::meet_as_sewn(int vertex, const std::array<int, 3>& t) const {
  const auto& x = sewn_.vertices;
  return (x[vertex] - at(x, t, closest(x, vertex, t))).norm() < near_as_sewn * thickness_;
}

void SheetContacts::find(const Places& places) {
  const Grid grid{longest_side(sewn_) + thickness_, table_size(places.size()) - 1};
  cell_begin_.assign(grid.mask + 2, 0);
  for (const auto& p : places) ++cell_begin_[grid.slot(grid.cell(p)) + 1];
  for (std::size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
  cell_vertices_.resize(places.size());
  std::vector<int> fill(cell_begin_.begin(), cell_begin_.end() - 1);
  for (std::size_t v = 0; v < places.size(); ++v) {
    cell_vertices_[fill[grid.slot(grid.cell(places[v]))]++] = static_cast<int>(v);
  }
  pairs_.clear();
  const double margin = search_radius * thickness_;
  std::vector<std::size_t> slots;
  for (std::size_t k = 0; k < sewn_.triangles.size(); ++k) {
    const auto& t = sewn_.triangles[k];
    Eigen::AlignedBox3d box(places[t[0]]);
    box.extend(places[t[1]]).extend(places[t[2]]);
    const Eigen::AlignedBox3d grown(box.min().array() - margin, box.max().array() + margin);
    const Vector3i low = grid.cell(grown.min()), high = grid.cell(grown.max());
    slots.clear();
    for (int i = low.x(); i <= high.x(); ++i) {
      for (int j = low.y(); j <= high.y(); ++j) {
        for (int l = low.z(); l <= high.z(); ++l) slots.push_back(grid.slot({i, j, l}));
      }
    }
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    for (const std::size_t slot : slots) {
      for (int i = cell_begin_[slot]; i < cell_begin_[slot + 1]; ++i) {
        const int v = cell_vertices_[i];
        if (!grown.contains(places[v]) || v == t[0] || v == t[1] || v == t[2]) continue;
        const double apart = (places[v] - at(places, t, closest(places, v, t))).norm();
        if (apart < margin && !meet_as_sewn(v, t)) pairs_.push_back({v, static_cast<int>(k)});
      }
    }
  }
}

void SheetContacts::relax(const Pair& pair, double parting, const Places& before, Places& places) const {
  const auto& t = sewn_.triangles[pair.triangle];
  const Vector3d weights = closest(places, pair.vertex, t);
  const Vector3d apart = places[pair.vertex] - at(places, t, weights);
  const Vector3d was = before[pair.vertex] - at(before, t, weights);
  Vector3d normal = normal_of(places, t).normalized();
  if (was.dot(normal_of(before, t)) < 0) normal = -normal;
  const bool beside = weights.minCoeff() == 0, passed = !beside && apart.dot(normal) < 0;
  const double distance = apart.norm();
  if (distance >= (passed ? 2 : 1) * thickness_ || !(distance > 0)) return;
  // beside the triangle the way out is from its border
  const Vector3d out = beside ? Vector3d(apart / distance) : normal;
  // what is too near already goes apart slowly, so that contacts take energy and give none
  const double missing = std::min(thickness_, was.dot(out) + parting) - apart.dot(out);
  double mobile = mobilities_[pair.vertex];
  for (int i = 0; i < 3; ++i) mobile += weights[i] * weights[i] * mobilities_[t[i]];
  if (!(mobile > 0) || missing <= 0) return;
  Vector3d slid = apart - was;
  slid -= slid.dot(out) * out;
  const double length = slid.norm(), held = friction_ * missing;
  const Vector3d push = (missing * out - (length > held ? held / length : 1.0) * slid) / mobile;
  places[pair.vertex] += mobilities_[pair.vertex] * push;
  for (int i = 0; i < 3; ++i) places[t[i]] -= weights[i] * mobilities_[t[i]] * push;
}

void SheetContacts::relax(double time_step, const Places& before, Places& places) const {
  for (const Pair& pair : pairs_) relax(pair, parting_speed * time_step, before, places);
}

}  // namespace greenloop::offline
