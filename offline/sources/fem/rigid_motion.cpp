#include "offline/sources/fem/rigid_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop::offline {
namespace {

int root_of(std::vector<int>& parent, int t) {
  while (parent[t] != t) t = parent[t] = parent[parent[t]];
  return t;
}

/// For every tetrahedron the smallest one of its piece.
std::vector<int> pieces(const TetrahedralMesh& mesh) {
  std::vector<std::pair<std::array<int, 3>, int>> faces;
  faces.reserve(4 * mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (int left_out = 0; left_out < 4; ++left_out) {
      std::array<int, 3> face{};
      for (int k = 0; k < 3; ++k) face[k] = mesh.tetrahedra[t][(left_out + 1 + k) % 4];
      std::sort(face.begin(), face.end());
      faces.emplace_back(face, static_cast<int>(t));
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<int> parent(mesh.tetrahedra.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].first != faces[f - 1].first) continue;
    const int a = root_of(parent, faces[f].second), b = root_of(parent, faces[f - 1].second);
    parent[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t t = 0; t < parent.size(); ++t) parent[t] = root_of(parent, static_cast<int>(t));
  return parent;
}

bool spans_a_plane(const std::vector<Eigen::Vector3d>& points, double size) {
  constexpr double kThin = 1e-9;
  if (points.size() < 3) return false;
  const auto farthest = *std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
    return (a - points[0]).squaredNorm() < (b - points[0]).squaredNorm();
  });
  const Eigen::Vector3d line = farthest - points[0];
  return std::any_of(points.begin(), points.end(),
                     [&](const Eigen::Vector3d& x) { return line.cross(x - points[0]).norm() > kThin * size * size; });
}

}  // namespace

void require_no_rigid_motion(const TetrahedralMesh& mesh, const std::vector<std::uint8_t>& fixed) {
  if (fixed.size() != mesh.vertices.size()) {
    throw std::invalid_argument("support: " + std::to_string(fixed.size()) + " vertices marked of " +
                                std::to_string(mesh.vertices.size()));
  }
  const auto piece = pieces(mesh);
  std::vector<std::vector<int>> held(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < piece.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) {
      if (fixed[v] != 0) held[piece[t]].push_back(v);
    }
  }
  Eigen::AlignedBox3d box;
  for (const auto& x : mesh.vertices) box.extend(x);
  for (std::size_t t = 0; t < piece.size(); ++t) {
    if (piece[t] != static_cast<int>(t)) continue;
    std::vector<Eigen::Vector3d> points;
    for (const int v : held[t]) points.push_back(mesh.vertices[v]);
    if (spans_a_plane(points, box.diagonal().norm())) continue;
    throw std::runtime_error("the body can move rigidly: the piece with vertex " +
                             std::to_string(mesh.tetrahedra[t][0]) +
                             " does not have three fixed vertices off one line; fix more of it");
  }
}

}  // namespace greenloop::offline
