#include "offline/wrap/deviation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace greenloop::offline {
namespace {

/// Whether a place lies in a cell that is partly outside.
bool near_outside(const Eigen::Vector3d& place, const std::vector<float>& field, const Lattice& lattice) {
  std::array<int, 3> low{};
  for (int a = 0; a < 3; ++a) low[a] = static_cast<int>(std::floor(place[a]));
  const std::size_t first = lattice.index(low);
  for (unsigned bits = 0; bits < 8; ++bits) {
    std::size_t point = first;
    for (int axis = 0; axis < 3; ++axis) {
      if ((bits >> static_cast<unsigned>(axis) & 1U) != 0) point += lattice.stride(axis);
    }
    if (field[point] >= 0) return true;
  }
  return false;
}

}  // namespace

Deviation deviation(const std::vector<Eigen::Vector3d>& places, const TriangleTree& surface, double offset) {
  constexpr std::size_t most_places = 100'000;
  const std::size_t step = places.size() / most_places + 1;
  Deviation result;
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < places.size(); i += step, ++count) {
    const double distance = std::abs(surface.distance(places[i]) - offset);
    result.greatest = std::max(result.greatest, distance);
    squares += distance * distance;
  }
  result.rms = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
  return result;
}

std::vector<Eigen::Vector3d> places_on_skin(const TriangleMesh& mesh, const std::vector<Crossing>& crossings,
                                            const std::vector<float>& field, const Lattice& lattice) {
  std::vector<Eigen::Vector3d> places;
  std::vector<bool> corner(mesh.vertices.size(), false);
  for (const auto& crossing : crossings) {
    const bool skin = (field[crossing.point] < 0) != (field[crossing.next_point(lattice)] < 0);
    if (!skin || !crossing.alone) continue;
    places.push_back(crossing.place(lattice));
    for (const int v : mesh.triangles[static_cast<std::size_t>(crossing.face)]) corner[v] = true;
  }
  for (std::size_t v = 0; v < corner.size(); ++v) {
    if (corner[v] && near_outside(mesh.vertices[v], field, lattice)) places.push_back(mesh.vertices[v]);
  }
  return places;
}

std::vector<Eigen::Vector3d> places_on(const TriangleMesh& mesh, const std::vector<bool>& counts) {
  std::vector<Eigen::Vector3d> places;
  for (const auto& [a, b, c] : mesh.triangles) {
    if (!counts[a] || !counts[b] || !counts[c]) continue;
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    for (const Eigen::Vector3d& place : {p, Eigen::Vector3d((p + q) / 2), Eigen::Vector3d((p + q + r) / 3)}) {
      places.push_back(place);
    }
  }
  return places;
}

}  // namespace greenloop::offline
