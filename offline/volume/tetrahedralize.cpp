#include "offline/volume/tetrahedralize.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/triangle_intersection.hpp"
#include "offline/volume/netgen_mesher.hpp"
#include "offline/volume/tetgen_mesher.hpp"

namespace greenloop::offline {
namespace {

void require_in_range(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw std::invalid_argument(std::string("tetrahedralize: ") + name + " is " + std::to_string(value) +
                              ", it must lie in " + std::to_string(low) + " .. " + std::to_string(high));
}

void require_valid(const TetrahedralizeOptions& options) {
  require_in_range("interior_growth", options.interior_growth, 1.0, 16.0);
  require_in_range("grading", options.grading, 0.1, 0.8);
  require_in_range("optimization_steps", options.optimization_steps, 0, 10);
}

/// Netgen may run forever on a surface that crosses itself.
void require_no_crossing(const TriangleMesh& surface) {
  const auto pairs = self_intersections(surface, std::vector<bool>(surface.triangles.size(), false));
  if (pairs.empty()) return;
  throw std::invalid_argument("tetrahedralize: the surface intersects itself in " + std::to_string(pairs.size()) +
                              " pairs of triangles, the first are " + std::to_string(pairs[0][0]) + " and " +
                              std::to_string(pairs[0][1]) + "; repair or remesh it");
}

/// Every directed edge exactly once, and its reverse too: closed, manifold along edges, consistently oriented.
void require_closed(const TriangleMesh& surface) {
  std::vector<std::pair<int, int>> edges;
  for (const auto& [a, b, c] : surface.triangles) edges.insert(edges.end(), {{a, b}, {b, c}, {c, a}});
  std::sort(edges.begin(), edges.end());
  const auto name = [](const std::pair<int, int>& e) {
    return "(" + std::to_string(e.first) + ", " + std::to_string(e.second) + ")";
  };
  if (const auto twice = std::adjacent_find(edges.begin(), edges.end()); twice != edges.end()) {
    throw std::invalid_argument("tetrahedralize: edge " + name(*twice) +
                                " is used twice in the same direction; the surface is not an oriented manifold");
  }
  for (const auto& edge : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), std::pair(edge.second, edge.first))) {
      throw std::invalid_argument("tetrahedralize: the surface is open at edge " + name(edge) +
                                  "; close the hole first");
    }
  }
}

void require_valid(const TriangleMesh& surface) {
  if (surface.triangles.empty()) throw std::invalid_argument("tetrahedralize: the surface has no triangles");
  const int count = static_cast<int>(surface.vertices.size());
  std::vector<char> used(surface.vertices.size(), 0);
  for (const auto& triangle : surface.triangles) {
    for (const int v : triangle) {
      if (v < 0 || v >= count) {
        throw std::invalid_argument("tetrahedralize: a triangle names vertex " + std::to_string(v) + " of " +
                                    std::to_string(count));
      }
      used[v] = 1;
    }
  }
  for (int v = 0; v < count; ++v) {
    if (!surface.vertices[v].allFinite() || used[v] == 0) {
      throw std::invalid_argument("tetrahedralize: surface vertex " + std::to_string(v) +
                                  (used[v] == 0 ? " belongs to no triangle" : " is not finite"));
    }
  }
  require_closed(surface);
  if (!(enclosed_volume(surface) > 0.0)) {
    throw std::invalid_argument("tetrahedralize: the surface encloses no positive volume; reverse its triangles");
  }
  require_no_crossing(surface);
}

using Mesher = std::function<TetrahedralMesh()>;

/// A checked result, or nothing and the reason appended to `reasons`.
std::optional<TetrahedralMesh> attempt(const Mesher& mesher, const TriangleMesh& surface, std::string& reasons) {
  try {
    auto mesh = mesher();
    require_fills_surface(mesh, surface);
    return mesh;
  } catch (const std::runtime_error& error) {
    reasons += std::string("\n  ") + error.what();
    return std::nullopt;
  }
}

void keep_better(std::optional<Tetrahedralization>& best, std::optional<TetrahedralMesh> mesh, const char* mesher) {
  if (!mesh) return;
  const auto quality = measure_quality(*mesh);
  if (best && best->quality.min_quality >= quality.min_quality) return;
  best = Tetrahedralization{*std::move(mesh), quality, mesher};
}

}  // namespace

Tetrahedralization tetrahedralize(const TriangleMesh& surface, const TetrahedralizeOptions& options) {
  require_valid(options);
  require_valid(surface);
  std::string reasons;
  std::optional<Tetrahedralization> best;
  for (const double turn : {0.0, 1.0, 2.0}) {
    if (best && best->quality.slivers == 0) break;
    keep_better(best, attempt([&] { return mesh_with_netgen(surface, options, turn); }, surface, reasons), "netgen");
  }
  if (best) return *std::move(best);
  if (tetgen_is_installed()) {
    keep_better(best, attempt([&] { return mesh_with_tetgen(surface); }, surface, reasons), "tetgen");
    if (best) return *std::move(best);
  } else {
    reasons += "\n  the program tetgen is not installed; it is tried when it is on PATH";
  }
  throw std::runtime_error("cannot fill the surface with tetrahedra" + reasons +
                           "\nRemesh the surface more evenly or at another level");
}

TriangleMesh finest_surface(const SemiRegularMesh& mesh) {
  return {mesh.positions, triangles_of_level(mesh, mesh.finest_level())};
}

}  // namespace greenloop::offline
