#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// A box of half sizes `half` with a hole of `sides` sides along z: every face a fan of needles to the box's corners.
inline TriangleMesh box_with_hole(const Eigen::Vector3d& half, double radius, int sides) {
  TriangleMesh mesh;
  const auto rim = [&](int top, int k) { return top * sides + k % sides; };
  const auto corner = [&](int top, int q) { return 2 * sides + 4 * top + q % 4; };
  for (const double z : {-half.z(), half.z()}) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  for (const double z : {-half.z(), half.z()}) {
    for (const auto& [x, y] : {std::array{1, 1}, std::array{-1, 1}, std::array{-1, -1}, std::array{1, -1}}) {
      mesh.vertices.emplace_back(x * half.x(), y * half.y(), z);
    }
  }
  const auto add = [&](int top, int a, int b, int c) {
    mesh.triangles.push_back(top == 1 ? std::array{a, b, c} : std::array{a, c, b});
  };
  for (const int top : {0, 1}) {
    for (int k = 0; k < sides; ++k) add(top, rim(top, k), corner(top, 4 * k / sides), rim(top, k + 1));
    for (int q = 0; q < 4; ++q) add(top, rim(top, (q + 1) * sides / 4), corner(top, q), corner(top, q + 1));
  }
  for (int k = 0; k < sides; ++k) {
    mesh.triangles.push_back({rim(0, k), rim(1, k), rim(0, k + 1)});
    mesh.triangles.push_back({rim(0, k + 1), rim(1, k), rim(1, k + 1)});
  }
  for (int q = 0; q < 4; ++q) {
    mesh.triangles.push_back({corner(0, q), corner(0, q + 1), corner(1, q)});
    mesh.triangles.push_back({corner(0, q + 1), corner(1, q + 1), corner(1, q)});
  }
  return mesh;
}

}  // namespace greenloop::offline
