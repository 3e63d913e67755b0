#include "offline/surface/surface_report.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/coincident_vertices.hpp"
#include "offline/surface/surface_edges.hpp"
#include "offline/surface/triangle_intersection.hpp"

namespace greenloop::offline {
namespace {

std::array<int, 2> ends(const HalfEdge& side) {
  return {std::min(side.tail, side.head), std::max(side.tail, side.head)};
}

void classify_edges(const SurfaceEdges& edges, SurfaceReport& report) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto sides = edges[e];
    if (sides.size() == 1) {
      report.boundary_edges.push_back(ends(sides[0]));
    } else if (sides.size() > 2) {
      report.non_manifold_edges.push_back(ends(sides[0]));
    } else if (sides[0].forward() == sides[1].forward()) {
      report.misoriented_edges.push_back(ends(sides[0]));
    }
  }
}

/// A vertex is manifold if its faces hang together through edges at that vertex. Corner 3 f + i is the i-th of face f.
void find_non_manifold_vertices(const TriangleMesh& mesh, const SurfaceEdges& edges, SurfaceReport& report) {
  DisjointSets fans(3 * mesh.triangles.size());
  const auto corner = [&](int face, int vertex) {
    const auto& t = mesh.triangles[face];
    return 3 * face + static_cast<int>(std::find(t.begin(), t.end(), vertex) - t.begin());
  };
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto sides = edges[e];
    for (const auto& side : sides) {
      for (const int vertex : {side.tail, side.head}) {
        fans.unite(corner(sides[0].face, vertex), corner(side.face, vertex));
      }
    }
  }
  std::vector<int> fan_of(mesh.vertices.size(), -1);
  std::vector<bool> split(mesh.vertices.size(), false);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const int vertex : mesh.triangles[f]) {
      const int fan = fans.find(corner(static_cast<int>(f), vertex));
      split[vertex] = split[vertex] || (fan_of[vertex] >= 0 && fan_of[vertex] != fan);
      fan_of[vertex] = fan;
    }
  }
  for (std::size_t v = 0; v < split.size(); ++v) {
    if (split[v]) {
      report.non_manifold_vertices.push_back(static_cast<int>(v));
    }
  }
}

void count_components(const TriangleMesh& mesh, const SurfaceEdges& edges, SurfaceReport& report) {
  DisjointSets pieces(mesh.triangles.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const auto& side : edges[e]) {
      pieces.unite(edges[e][0].face, side.face);
    }
  }
  struct Piece {
    std::size_t size = 0;
    int first_face = -1;
  };
  std::map<int, Piece> found;  // by the smallest face
  for (int f = 0; f < static_cast<int>(mesh.triangles.size()); ++f) {
    ++found[pieces.find(f)].size;
  }
  std::vector<Piece> sorted;
  sorted.reserve(found.size());
  for (const auto& [first_face, piece] : found) {
    sorted.push_back({piece.size, first_face});
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const Piece& a, const Piece& b) { return a.size > b.size; });
  for (const auto& piece : sorted) {
    report.component_sizes.push_back(piece.size);
    report.component_first_face.push_back(piece.first_face);
  }
}

void count_vertices(const TriangleMesh& mesh, std::size_t edge_count, SurfaceReport& report) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& triangle : mesh.triangles) {
    for (const int vertex : triangle) {
      used[vertex] = true;
    }
  }
  const auto first = first_coincident_vertex(mesh.vertices);
  for (int v = 0; v < static_cast<int>(used.size()); ++v) {
    if (!used[v]) {
      report.unreferenced_vertices.push_back(v);
    }
    if (first[v] != v) {
      report.duplicate_vertices.push_back({v, first[v]});
    }
    report.box.extend(mesh.vertices[v]);
  }
  const auto used_count = static_cast<long>(std::count(used.begin(), used.end(), true));
  report.euler_characteristic =
      static_cast<int>(used_count - static_cast<long>(edge_count) + static_cast<long>(mesh.triangles.size()));
}

void find_duplicate_faces(const TriangleMesh& mesh, SurfaceReport& report) {
  std::map<std::array<int, 3>, int> first;
  for (int f = 0; f < static_cast<int>(mesh.triangles.size()); ++f) {
    auto key = mesh.triangles[f];
    std::sort(key.begin(), key.end());
    const auto [it, fresh] = first.try_emplace(key, f);
    if (!fresh) {
      report.duplicate_faces.push_back({f, it->second});
    }
  }
}

void measure_faces(const TriangleMesh& mesh, SurfaceReport& report) {
  report.worst_quality = mesh.triangles.empty() ? 0 : std::numeric_limits<double>::infinity();
  for (int f = 0; f < static_cast<int>(mesh.triangles.size()); ++f) {
    const auto& [i, j, k] = mesh.triangles[f];
    const auto &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    const double twice_area = (b - a).cross(c - a).norm();
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    const double quality = longest > 0 ? twice_area / longest : 0;
    report.area += twice_area / 2;
    if (quality < report.worst_quality) {
      report.worst_quality = quality;
      report.worst_face = f;
    }
    if (quality <= smallest_quality || i == j || j == k || k == i) {
      report.zero_area_faces.push_back(f);
    }
  }
}

}  // namespace

bool is_closed_manifold(const TriangleMesh& mesh) {
  SurfaceReport report;
  const SurfaceEdges edges(mesh.triangles);
  classify_edges(edges, report);
  find_non_manifold_vertices(mesh, edges, report);
  return report.closed() && report.manifold();
}

SurfaceReport check_connectivity(const TriangleMesh& mesh) {
  SurfaceReport report;
  report.vertex_count = mesh.vertices.size();
  report.triangle_count = mesh.triangles.size();
  const SurfaceEdges edges(mesh.triangles);
  classify_edges(edges, report);
  find_non_manifold_vertices(mesh, edges, report);
  count_components(mesh, edges, report);
  count_vertices(mesh, edges.size(), report);
  find_duplicate_faces(mesh, report);
  measure_faces(mesh, report);
  if (report.closed() && report.non_manifold_edges.empty() && report.oriented() && !mesh.triangles.empty()) {
    report.volume = enclosed_volume(mesh);
  }
  return report;
}

SurfaceReport check_surface(const TriangleMesh& mesh) {
  SurfaceReport report = check_connectivity(mesh);
  std::vector<bool> degenerate(mesh.triangles.size(), false);
  for (const int face : report.zero_area_faces) {
    degenerate[face] = true;
  }
  report.intersecting_faces = self_intersections(mesh, degenerate);
  return report;
}

}  // namespace greenloop::offline
