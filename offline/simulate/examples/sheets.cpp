#include "offline/simulate/examples/sheets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace greenloop::offline::examples {
namespace {

constexpr int leaves = 14;

void require_cells(int cells) {
  if (cells < 6 || cells > 200) throw std::invalid_argument("sheets: 6 to 200 cells");
}

/// A grid of vertices across and along, cut into triangles whose diagonals alternate.
template <class Place>
void add_grid(TriangleMesh& mesh, int across, int along, const Place& place) {
  const int first = static_cast<int>(mesh.vertices.size());
  const auto vertex = [&](int i, int j) { return first + j * (across + 1) + i; };
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i <= across; ++i) mesh.vertices.push_back(place(double(i) / across, double(j) / along));
  }
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < across; ++i) {
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      if ((i + j) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      }
    }
  }
}

}  // namespace

TriangleMesh cloth(int cells) {
  require_cells(cells);
  constexpr double width = 0.52, left = 0.2, top = -0.2;
  TriangleMesh mesh;
  add_grid(mesh, cells, cells, [](double s, double t) {
    constexpr double pleats = 3, depth = 0.018;
    return Eigen::Vector3d(left + width * s, top - 0.6 * t, 0.05 + depth * std::cos(2 * std::numbers::pi * pleats * s));
  });
  return mesh;
}

TriangleMesh plant(int cells) {
  require_cells(cells);
  TriangleMesh mesh;
  for (int leaf = 0; leaf < leaves; ++leaf) {
    const bool upper = leaf % 2 == 1;
    const double turn = 2 * std::numbers::pi * leaf / leaves, steep = upper ? 1.08 : 0.95;
    const double length = 0.22, start = upper ? 0.036 : 0.05;
    const Eigen::Vector3d out(std::cos(turn), 0, std::sin(turn)), side(-std::sin(turn), 0, std::cos(turn));
    add_grid(mesh, std::max(2, cells / 10 * 2), cells, [&](double s, double t) {
      // bent over from the steep start, widest at a third, creased along its middle
      const double bent = 1.2, angle = steep - bent * t, across = 2 * s - 1;
      const double reach = length / bent * (std::sin(steep) - std::sin(angle));
      const double height = length / bent * (std::cos(angle) - std::cos(steep));
      const double half_width = 0.004 + 0.1 * t * (1 - t);
      const Eigen::Vector3d up = std::cos(angle) * Eigen::Vector3d::UnitY() - std::sin(angle) * out;
      return Eigen::Vector3d((start + reach) * out + height * Eigen::Vector3d::UnitY() +
                             half_width * (across * side + 0.5 * std::abs(across) * up));
    });
  }
  return mesh;
}

}  // namespace greenloop::offline::examples
