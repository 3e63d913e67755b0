#include "offline/volume/tetrahedra_quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "offline/surface/area_and_volume.hpp"

namespace greenloop::offline {
namespace {

using Triangle = std::array<int, 3>;

/// Rotated so that the smallest index comes first; the orientation stays.
Triangle canonical(const Triangle& t) {
  const auto first = std::min_element(t.begin(), t.end()) - t.begin();
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

Triangle reversed(const Triangle& t) { return canonical({t[0], t[2], t[1]}); }

std::array<Triangle, 4> outward_faces(const std::array<int, 4>& t) {
  return {{{t[1], t[2], t[3]}, {t[0], t[3], t[2]}, {t[0], t[1], t[3]}, {t[0], t[2], t[1]}}};
}

std::string name_of(const Triangle& t) {
  return "(" + std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " + std::to_string(t[2]) + ")";
}

double signed_volume(const TetrahedralMesh& mesh, const std::array<int, 4>& t) {
  const auto& origin = mesh.vertices[t[0]];
  const Eigen::Vector3d a = mesh.vertices[t[1]] - origin;
  const Eigen::Vector3d b = mesh.vertices[t[2]] - origin;
  const Eigen::Vector3d c = mesh.vertices[t[3]] - origin;
  return a.dot(b.cross(c)) / 6.0;
}

double mean_ratio(const TetrahedralMesh& mesh, const std::array<int, 4>& t, double volume) {
  double squared_edges = 0.0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) squared_edges += (mesh.vertices[t[a]] - mesh.vertices[t[b]]).squaredNorm();
  }
  const double ratio = 12.0 * std::cbrt(9.0 * volume * volume) / squared_edges;
  return volume > 0.0 ? ratio : -ratio;
}

void require_valid_indices(const TetrahedralMesh& mesh) {
  const int count = static_cast<int>(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) {
      if (v < 0 || v >= count) {
        throw std::invalid_argument("tetrahedron " + std::to_string(t) + " names vertex " + std::to_string(v) +
                                    ", but there are " + std::to_string(count) + " vertices (numbered from 0)");
      }
    }
  }
}

void require_same_vertices(const TetrahedralMesh& mesh, const TriangleMesh& surface) {
  if (mesh.vertices.size() < surface.vertices.size()) {
    throw std::runtime_error("tetrahedral mesh: " + std::to_string(mesh.vertices.size()) +
                             " vertices are fewer than the surface's " + std::to_string(surface.vertices.size()));
  }
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    if (mesh.vertices[v] != surface.vertices[v]) {
      throw std::runtime_error("tetrahedral mesh: surface vertex " + std::to_string(v) + " was moved");
    }
  }
}

void require_same_boundary(const TetrahedralMesh& mesh, const TriangleMesh& surface) {
  auto found = boundary_triangles(mesh);
  auto given = surface.triangles;
  for (auto* list : {&found, &given}) {
    std::transform(list->begin(), list->end(), list->begin(), canonical);
    std::sort(list->begin(), list->end());
  }
  std::vector<Triangle> difference;
  std::set_difference(given.begin(), given.end(), found.begin(), found.end(), std::back_inserter(difference));
  if (!difference.empty()) {
    throw std::runtime_error("tetrahedral mesh: " + std::to_string(difference.size()) +
                             " surface triangles are not faces of the volume, the first is " + name_of(difference[0]));
  }
  if (found.size() != given.size()) {
    throw std::runtime_error("tetrahedral mesh: " + std::to_string(found.size()) + " boundary triangles instead of " +
                             std::to_string(given.size()));
  }
}

}  // namespace

TetrahedraQuality measure_quality(const TetrahedralMesh& mesh) {
  require_valid_indices(mesh);
  TetrahedraQuality quality;
  for (const auto& t : mesh.tetrahedra) {
    const double volume = signed_volume(mesh, t);
    const double ratio = mean_ratio(mesh, t, volume);
    quality.volume += volume;
    quality.min_quality = std::min(quality.min_quality, ratio);
    quality.slivers += ratio < kSliverQuality ? 1 : 0;
    quality.inverted += volume > 0.0 ? 0 : 1;
  }
  std::vector<char> on_boundary(mesh.vertices.size(), 0);
  for (const auto& triangle : boundary_triangles(mesh)) {
    for (const int v : triangle) on_boundary[v] = 1;
  }
  quality.interior_nodes = static_cast<std::size_t>(std::count(on_boundary.begin(), on_boundary.end(), 0));
  return quality;
}

std::vector<std::array<int, 3>> boundary_triangles(const TetrahedralMesh& mesh) {
  std::vector<Triangle> faces;
  faces.reserve(4 * mesh.tetrahedra.size());
  for (const auto& t : mesh.tetrahedra) {
    for (const auto& face : outward_faces(t)) faces.push_back(canonical(face));
  }
  auto sorted = faces;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) {
    throw std::runtime_error("tetrahedral mesh: two tetrahedra lie on the same side of face " + name_of(*twice) +
                             "; the mesh overlaps itself or an element is inverted");
  }
  std::erase_if(faces,
                [&](const Triangle& f) { return std::binary_search(sorted.begin(), sorted.end(), reversed(f)); });
  return faces;
}

void require_fills_surface(const TetrahedralMesh& mesh, const TriangleMesh& surface) {
  require_valid_indices(mesh);
  require_same_vertices(mesh, surface);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (!(signed_volume(mesh, mesh.tetrahedra[t]) > 0.0)) {
      throw std::runtime_error("tetrahedral mesh: tetrahedron " + std::to_string(t) + " has no positive volume");
    }
  }
  require_same_boundary(mesh, surface);
  const double expected = enclosed_volume(surface);
  const double volume = measure_quality(mesh).volume;
  if (!(std::abs(volume - expected) <= 1e-9 * expected)) {
    throw std::runtime_error("tetrahedral mesh: volume " + std::to_string(volume) + " instead of the surface's " +
                             std::to_string(expected));
  }
}

}  // namespace greenloop::offline
