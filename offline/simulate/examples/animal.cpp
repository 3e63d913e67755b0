#include "offline/simulate/examples/animal.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "offline/simulate/examples/subdivision.hpp"

namespace greenloop::offline::examples {
namespace {

using Cube = std::array<int, 3>;  // its lowest corner

std::set<Cube> cubes_of_animal() {
  std::set<Cube> cubes;
  const auto fill = [&](Cube low, Cube high) {
    for (int x = low[0]; x < high[0]; ++x) {
      for (int y = low[1]; y < high[1]; ++y) {
        for (int z = low[2]; z < high[2]; ++z) cubes.insert({x, y, z});
      }
    }
  };
  fill({0, 1, -1}, {4, 3, 2});  // trunk
  for (const int x : {0, 3}) {
    for (const int z : {-1, 1}) fill({x, -1, z}, {x + 1, 1, z + 1});  // legs
  }
  fill({-3, 2, 0}, {0, 3, 1});  // tail
  fill({3, 3, 0}, {4, 5, 1});   // neck
  fill({4, 4, 0}, {5, 5, 1});   // head
  return cubes;
}

/// Where a corner of the cubes goes: a tail that tapers, a neck that bends forward, a flat head.
Eigen::Vector3d placed(const Cube& c) {
  Eigen::Vector3d p(c[0], c[1], c[2] - 0.5);
  if (c[0] < 0) {
    const double along = -p.x() / 3;
    p.z() *= 1 - 0.4 * along;
    p.y() = 2.6 + (p.y() - 2.6) * (1 - 0.4 * along) - 0.4 * along;
  }
  if (c[1] > 3 && c[0] < 5) p.x() += 0.2;
  if (c[0] == 5) p.y() = 4.4 + 0.8 * (p.y() - 4.4);
  return p;
}

class CageOfCubes {
 public:
  explicit CageOfCubes(const std::set<Cube>& cubes) {
    for (const Cube& cube : cubes) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {0, 1}) {
          Cube next = cube;
          next[axis] += side == 1 ? 1 : -1;
          if (cubes.count(next) == 0) add_face(cube, axis, side);
        }
      }
    }
    cage_.corner.resize(cage_.mesh.vertices.size(), 0);
    for (const int tip : tips_) cage_.corner[tip] = 1;
  }

  [[nodiscard]] const Cage& cage() const { return cage_; }

 private:
  int vertex(const Cube& at) {
    const auto [it, is_new] = number_.try_emplace(at, static_cast<int>(cage_.mesh.vertices.size()));
    if (is_new) cage_.mesh.vertices.push_back(placed(at));
    return it->second;
  }

  /// The face of a cube on one side of an axis, seen from outside, as two triangles or as a spine.
  void add_face(const Cube& cube, int axis, int side) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<int, 4> corner{};
    constexpr std::array<std::array<int, 2>, 4> around{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (int i = 0; i < 4; ++i) {
      Cube at = cube;
      at[axis] += side;
      at[u] += around[i][0];
      at[v] += around[i][1];
      corner[side == 1 ? i : 3 - i] = vertex(at);
    }
    const bool on_the_back = axis == 1 && side == 1 && cube[1] == 2 && cube[0] < 3 && (cube[0] < 0 || cube[2] != 0);
    auto& triangles = cage_.mesh.triangles;
    if (on_the_back) {
      const int tip = add_tip(corner, cube[0]);
      for (int i = 0; i < 4; ++i) triangles.push_back({corner[i], corner[(i + 1) % 4], tip});
    } else {
      triangles.push_back({corner[0], corner[1], corner[2]});
      triangles.push_back({corner[0], corner[2], corner[3]});
    }
  }

  int add_tip(const std::array<int, 4>& corner, int along) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int c : corner) middle += cage_.mesh.vertices[c] / 4;
    const double height = along < 0 ? 0.8 : 1.2;
    cage_.mesh.vertices.push_back(middle + height * Eigen::Vector3d(-0.2, 1, 0.25 * middle.z()));
    tips_.push_back(static_cast<int>(cage_.mesh.vertices.size()) - 1);
    return tips_.back();
  }

  Cage cage_;
  std::map<Cube, int> number_;
  std::vector<int> tips_;
};

std::vector<Eigen::Vector3d> normals_of(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const int v : {a, b, c}) normals[v] += area;
  }
  for (auto& normal : normals) normal.normalize();
  return normals;
}

/// Height of the scales at a place.
double scale_height(const Eigen::Vector3d& p) {
  const double x = 14 * p.x(), y = 14 * p.y(), z = 14 * p.z();
  return 0.02 * std::abs(std::sin(x + 0.5 * y) * std::sin(y - 0.5 * z) + std::sin(z + 0.5 * x));
}

}  // namespace

TriangleMesh animal(int levels) {
  if (levels < 0 || levels > 6) throw std::invalid_argument("animal: 0 to 6 levels");
  TriangleMesh mesh = subdivide(CageOfCubes(cubes_of_animal()).cage(), levels);
  if (levels < 2) return mesh;
  const auto normals = normals_of(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) mesh.vertices[v] += scale_height(mesh.vertices[v]) * normals[v];
  return mesh;
}

}  // namespace greenloop::offline::examples
