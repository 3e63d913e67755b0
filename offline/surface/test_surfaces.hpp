#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "offline/surface/shells.hpp"

namespace greenloop::offline {

/// A mesh of the folder of fetched test data.
inline TriangleMesh fetched_surface(const std::string& name) {
  const char* data = std::getenv("GREENLOOP_DATA");
  REQUIRE_MESSAGE(data != nullptr, "GREENLOOP_DATA is not set; run the tests through ctest");
  return read_surface(std::string(data) + "/" + name);
}

/// A cube of side 1 with its lower corner at `corner`, outward oriented.
inline TriangleMesh cube(const Eigen::Vector3d& corner = Eigen::Vector3d::Zero()) {
  TriangleMesh mesh;
  for (int v = 0; v < 8; ++v) {
    mesh.vertices.push_back(corner + Eigen::Vector3d(v & 1, (v >> 1) & 1, v >> 2));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Every face with vertices of its own.
inline TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh result;
  for (const auto& triangle : mesh.triangles) {
    const int first = static_cast<int>(result.vertices.size());
    for (const int vertex : triangle) {
      result.vertices.push_back(mesh.vertices[vertex]);
    }
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

}  // namespace greenloop::offline
