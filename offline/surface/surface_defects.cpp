#include <algorithm>
#include <array>
#include <cstdio>

#include "offline/surface/surface_report.hpp"
#include "offline/surface/triangle_intersection.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t examples_shown = 3;

std::string at(const Eigen::Vector3d& p) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "(%.6g, %.6g, %.6g)", p.x(), p.y(), p.z());
  return text.data();
}

Eigen::Vector3d centre(const TriangleMesh& mesh, int face) {
  const auto& [a, b, c] = mesh.triangles[face];
  return (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3;
}

bool has_vertex(const std::array<int, 3>& triangle, int vertex) {
  return std::find(triangle.begin(), triangle.end(), vertex) != triangle.end();
}

/// "faces 3, 8, 9" of those that pass the test.
template <typename Test>
std::string faces_where(const TriangleMesh& mesh, const Test& test) {
  std::string text;
  std::size_t found = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (test(mesh.triangles[f])) {
      text += (found == 0 ? "face " : ", ") + std::to_string(f);
      ++found;
    }
  }
  return found > 1 ? "faces" + text.substr(4) : text;
}

std::string edge_text(const TriangleMesh& mesh, const std::array<int, 2>& edge) {
  return faces_where(mesh, [&](const auto& t) { return has_vertex(t, edge[0]) && has_vertex(t, edge[1]); }) +
         " between " + at(mesh.vertices[edge[0]]) + " and " + at(mesh.vertices[edge[1]]);
}

std::string vertex_text(const TriangleMesh& mesh, int vertex) {
  return at(mesh.vertices[vertex]) + " in " + faces_where(mesh, [&](const auto& t) { return has_vertex(t, vertex); });
}

std::string face_text(const TriangleMesh& mesh, int face) {
  return "face " + std::to_string(face) + " at " + at(centre(mesh, face));
}

std::string pair_text(const TriangleMesh& mesh, const std::array<int, 2>& pair) {
  return "faces " + std::to_string(pair[0]) + " and " + std::to_string(pair[1]) + " at " + at(centre(mesh, pair[0]));
}

/// "12 things: first; second; third; ...: advice", nothing if the list is empty.
template <typename Item, typename Show>
void add(std::vector<std::string>& defects, const std::vector<Item>& items, const std::string& one,
         const std::string& many, const std::string& advice, const Show& show) {
  if (items.empty()) {
    return;
  }
  std::string text = std::to_string(items.size()) + " " + (items.size() == 1 ? one : many) + ": ";
  for (std::size_t i = 0; i < std::min(items.size(), examples_shown); ++i) {
    text += (i > 0 ? "; " : "") + show(items[i]);
  }
  defects.push_back(text + (items.size() > examples_shown ? "; ... " : ". ") + advice);
}

void add_components(std::vector<std::string>& defects, const TriangleMesh& mesh, const SurfaceReport& report) {
  const auto count = report.component_sizes.size();
  if (count == 1) {
    return;
  }
  if (count == 0) {
    defects.emplace_back("no faces at all");
    return;
  }
  std::string text = "several pieces: " + std::to_string(count) + " that share no edge, of ";
  for (std::size_t i = 0; i < std::min(count, examples_shown); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(report.component_sizes[i]) + " faces (" +
            face_text(mesh, report.component_first_face[i]) + ")";
  }
  defects.push_back(
      text + (count > examples_shown ? ", ... " : ". ") +
      "Keep one piece in the file, or join them by a boolean union; closed pieces inside the largest are cavities "
      "if [surface] says cavities = true.");
}

}  // namespace

std::vector<std::string> describe_defects(const TriangleMesh& mesh, const SurfaceReport& report) {
  std::vector<std::string> defects;
  const auto edge = [&](const std::array<int, 2>& e) { return edge_text(mesh, e); };
  const auto pair = [&](const std::array<int, 2>& p) { return pair_text(mesh, p); };
  const std::string merging_fails =
      report.duplicate_vertices.empty()
          ? ""
          : " (" + std::to_string(report.duplicate_vertices.size()) +
                " vertices lie exactly on another; merging them does not give a closed manifold surface.)";
  add(defects, report.boundary_edges, "boundary edge (the surface is open)", "boundary edges (the surface is open)",
      "Close the holes; a seam of vertices that almost coincide has to be merged." + merging_fails, edge);
  add(defects, report.non_manifold_edges, "non-manifold edge (of more than two faces)",
      "non-manifold edges (of more than two faces)", "Remove inner walls and faces that stick out.", edge);
  add(defects, report.non_manifold_vertices, "non-manifold vertex (where sheets meet in a point)",
      "non-manifold vertices (where sheets meet in a point)", "Split the vertex into one for each sheet.",
      [&](int v) { return vertex_text(mesh, v); });
  add_components(defects, mesh, report);
  add(defects, report.misoriented_edges, "edge along which two faces disagree about the outside",
      "edges along which two faces disagree about the outside", "The surface has no outside (it is not orientable).",
      edge);
  add(defects, report.zero_area_faces, "face of zero area", "faces of zero area",
      "Collapse their short edges or flip their long ones.", [&](int f) { return face_text(mesh, f); });
  add(defects, report.duplicate_faces, "face that occurs twice", "faces that occur twice", "Delete one of each.", pair);
  const std::string pairs = report.intersecting_faces.size() < most_pairs
                                ? "pairs of faces that intersect"
                                : "pairs of faces that intersect, and perhaps more";
  add(defects, report.intersecting_faces, "pair of faces that intersect", pairs,
      "Move them apart, or rebuild the skin by a boolean union or a voxel remesh.", pair);
  if (defects.empty() && report.volume == 0) {
    defects.emplace_back("the surface encloses no volume");
  }
  return defects;
}

}  // namespace greenloop::offline
