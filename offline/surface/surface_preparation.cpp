#include "offline/surface/surface_preparation.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>

#include "offline/surface/coincident_vertices.hpp"
#include "offline/surface/shells.hpp"
#include "offline/surface/surface_edges.hpp"

namespace greenloop::offline {
namespace {

std::string joined(const std::vector<std::string>& defects, const std::vector<std::string>& repairs) {
  std::string text = "the surface does not enclose one solid:";
  for (const auto& defect : defects) {
    text += "\n  - " + defect;
  }
  for (const auto& repair : repairs) {
    text += "\n  (repaired before: " + repair + ")";
  }
  return text;
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// A way to repair the connectivity, and what it did.
struct Candidate {
  TriangleMesh mesh;
  std::vector<std::string> repairs;
  std::size_t merged_count = 0;
};

/// Only vertices on a boundary are merged: elsewhere two sheets may touch in a point on purpose.
std::vector<bool> boundary_vertices(const TriangleMesh& mesh) {
  std::vector<bool> result(mesh.vertices.size(), false);
  const SurfaceEdges edges(mesh.triangles);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (edges[e].size() == 1) {
      result[edges[e][0].tail] = true;
      result[edges[e][0].head] = true;
    }
  }
  return result;
}

void merge_coincident_vertices(Candidate& candidate) {
  const auto first = first_coincident_vertex(candidate.mesh.vertices);
  const auto boundary = boundary_vertices(candidate.mesh);
  std::vector<int> target(first.size(), -1);  // per position, its first vertex on a boundary
  for (std::size_t v = first.size(); v-- > 0;) {
    if (boundary[v]) {
      target[first[v]] = static_cast<int>(v);
    }
  }
  std::set<int> merged;
  for (auto& triangle : candidate.mesh.triangles) {
    for (int& vertex : triangle) {
      if (boundary[vertex] && target[first[vertex]] != vertex) {
        merged.insert(vertex);
        vertex = target[first[vertex]];
      }
    }
  }
  candidate.merged_count += merged.size();
  if (!merged.empty()) {
    candidate.repairs.push_back(counted(merged.size(), "vertex", "vertices") +
                                " at exactly the same position as another merged into it");
  }
}

void drop_duplicate_faces(Candidate& candidate) {
  std::set<std::array<int, 3>> seen;
  std::vector<std::array<int, 3>> kept;
  for (const auto& triangle : candidate.mesh.triangles) {
    auto key = triangle;
    std::sort(key.begin(), key.end());
    if (seen.insert(key).second) {
      kept.push_back(triangle);
    }
  }
  const auto dropped = candidate.mesh.triangles.size() - kept.size();
  if (dropped > 0) {
    candidate.repairs.push_back(counted(dropped, "face that occurs", "faces that occur") + " twice dropped");
    candidate.mesh.triangles = std::move(kept);
  }
}

/// Merges the vertices that are `considered` within a distance of each other; returns how many faces that collapsed,
/// which are dropped.
std::size_t weld_vertices(Candidate& candidate, double distance, const std::vector<bool>& considered) {
  const auto target = first_vertex_within(candidate.mesh.vertices, distance, considered);
  std::set<int> merged;
  std::vector<std::array<int, 3>> kept;
  for (auto triangle : candidate.mesh.triangles) {
    for (int& vertex : triangle) {
      if (target[vertex] != vertex) {
        merged.insert(vertex);
        vertex = target[vertex];
      }
    }
    const auto& [a, b, c] = triangle;
    if (a != b && b != c && c != a) {
      kept.push_back(triangle);
    }
  }
  const auto collapsed = candidate.mesh.triangles.size() - kept.size();
  candidate.mesh.triangles = std::move(kept);
  candidate.merged_count += merged.size();
  if (!merged.empty()) {
    candidate.repairs.push_back(counted(merged.size(), "vertex", "vertices") + " within " + shortest(distance) +
                                " of another welded to it");
  }
  if (collapsed > 0) {
    candidate.repairs.push_back(counted(collapsed, "face", "faces") + " without an area left dropped");
  }
  return collapsed;
}

double diagonal(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : mesh.vertices) {
    box.extend(vertex);
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

/// The shortest weld of the boundary that closes the surface and collapses nothing but what rounding made.
std::optional<Candidate> weld_boundary(const Candidate& start) {
  constexpr double rounding = 1e-12;
  constexpr std::array distances{rounding, 1e-9, 1e-7, 1e-6, 1e-5};  // of the diagonal
  const double size = diagonal(start.mesh);
  const auto boundary = boundary_vertices(start.mesh);
  if (!(size > 0) || std::none_of(boundary.begin(), boundary.end(), [](bool on) { return on; })) {
    return std::nullopt;
  }
  for (const double distance : distances) {
    Candidate candidate = start;
    if (weld_vertices(candidate, distance * size, boundary) > 0 && distance > rounding) {
      return std::nullopt;
    }
    drop_duplicate_faces(candidate);
    if (is_closed_manifold(candidate.mesh)) {
      return candidate;
    }
  }
  return std::nullopt;
}

/// The mildest repair of the connectivity that closes the surface; the mesh as it is if none does.
Candidate repair_connectivity(const Candidate& start, bool weld) {
  for (const bool merge : {false, true}) {
    for (const bool drop : {false, true}) {
      Candidate candidate = start;
      if (merge) {
        merge_coincident_vertices(candidate);
      }
      if (drop) {
        drop_duplicate_faces(candidate);
      }
      if (is_closed_manifold(candidate.mesh)) {
        return candidate;
      }
    }
  }
  return (weld ? weld_boundary(start) : std::nullopt).value_or(start);
}

void drop_unreferenced_vertices(Candidate& candidate) {
  auto& mesh = candidate.mesh;
  std::vector<int> renumbered(mesh.vertices.size(), -1);
  for (const auto& triangle : mesh.triangles) {
    for (const int vertex : triangle) {
      renumbered[vertex] = 0;
    }
  }
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == 0) {
      renumbered[v] = static_cast<int>(kept.size());
      kept.push_back(mesh.vertices[v]);
    }
  }
  for (auto& triangle : mesh.triangles) {
    for (int& vertex : triangle) {
      vertex = renumbered[vertex];
    }
  }
  const auto dropped = mesh.vertices.size() - kept.size() - candidate.merged_count;  // merging is told already
  if (dropped > 0) {
    candidate.repairs.push_back(counted(dropped, "vertex", "vertices") + " in no face dropped");
  }
  mesh.vertices = std::move(kept);
}

/// For each face whether it has to be turned for neighbours to agree; nothing if no choice makes them agree (a Klein
/// bottle). Crosses edges of two faces only.
std::optional<std::vector<bool>> consistent_turns(const TriangleMesh& mesh) {
  struct Neighbour {
    int face;
    bool opposite;
  };
  const SurfaceEdges edges(mesh.triangles);
  std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (const auto sides = edges[e]; sides.size() == 2) {
      const bool opposite = sides[0].forward() == sides[1].forward();
      neighbours[sides[0].face].push_back({sides[1].face, opposite});
      neighbours[sides[1].face].push_back({sides[0].face, opposite});
    }
  }
  constexpr int unknown = -1;
  std::vector<int> turn(mesh.triangles.size(), unknown);
  std::vector<int> stack;
  for (std::size_t seed = 0; seed < turn.size(); ++seed) {
    if (turn[seed] != unknown) {
      continue;
    }
    turn[seed] = 0;
    stack.push_back(static_cast<int>(seed));
    while (!stack.empty()) {
      const int face = stack.back();
      stack.pop_back();
      for (const auto& [other, opposite] : neighbours[face]) {
        const int wanted = opposite ? 1 - turn[face] : turn[face];
        if (turn[other] == unknown) {
          turn[other] = wanted;
          stack.push_back(other);
        } else if (turn[other] != wanted) {
          return std::nullopt;
        }
      }
    }
  }
  std::vector<bool> result(turn.size());
  std::transform(turn.begin(), turn.end(), result.begin(), [](int t) { return t == 1; });
  return result;
}

void turn_face(std::array<int, 3>& triangle) { std::swap(triangle[1], triangle[2]); }

void orient_consistently(Candidate& candidate) {
  auto& triangles = candidate.mesh.triangles;
  auto turns = consistent_turns(candidate.mesh);
  if (!turns) {
    return;
  }
  auto count = static_cast<std::size_t>(std::count(turns->begin(), turns->end(), true));
  if (2 * count > triangles.size()) {  // keep the orientation of the majority
    turns->flip();
    count = triangles.size() - count;
  }
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if ((*turns)[f]) {
      turn_face(triangles[f]);
    }
  }
  if (count > 0) {
    candidate.repairs.push_back(counted(count, "face", "faces") + " turned to agree with their neighbours");
  }
}

bool only_in_pieces(const SurfaceReport& report, const std::vector<std::string>& defects) {
  return report.component_sizes.size() > 1 && defects.size() == 1;
}

/// Leaves the skin; or nothing is changed and the defect is returned.
std::vector<std::string> take_out_cavities(TriangleMesh& mesh, std::vector<TriangleMesh>& cavities) {
  try {
    Shells shells = split_shells(mesh);
    mesh = std::move(shells.skin);
    cavities = std::move(shells.cavities);
    return {};
  } catch (const std::runtime_error& error) {
    return {error.what()};
  }
}

}  // namespace

SurfaceError::SurfaceError(std::vector<std::string> defects, const std::vector<std::string>& repairs,
                           SurfaceReport report)
    : std::runtime_error(joined(defects, repairs)), defects_(std::move(defects)), report_(std::move(report)) {}

PreparedSurface prepare_surface(const TriangleMesh& mesh, Weld weld, Inside inside) {
  Candidate start{mesh, {}, 0};
  if (weld.value_or(0) > 0) {
    weld_vertices(start, *weld, std::vector<bool>(mesh.vertices.size(), true));
  }
  auto candidate = repair_connectivity(start, !weld);
  drop_unreferenced_vertices(candidate);
  orient_consistently(candidate);
  auto report = check_surface(candidate.mesh);
  if (report.inward()) {
    std::for_each(candidate.mesh.triangles.begin(), candidate.mesh.triangles.end(), turn_face);
    report.volume = -report.volume;
    candidate.repairs.emplace_back("all faces looked inwards and were turned outwards");
  }
  std::vector<TriangleMesh> cavities;
  auto defects = describe_defects(candidate.mesh, report);
  if (inside == Inside::cavities && only_in_pieces(report, defects)) {
    defects = take_out_cavities(candidate.mesh, cavities);
    report = check_surface(candidate.mesh);
  }
  if (!defects.empty()) {
    throw SurfaceError(std::move(defects), candidate.repairs, std::move(report));
  }
  return {std::move(candidate.mesh), std::move(candidate.repairs), std::move(report), std::move(cavities)};
}

}  // namespace greenloop::offline
