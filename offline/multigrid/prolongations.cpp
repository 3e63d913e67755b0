#include "offline/multigrid/prolongations.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "offline/multigrid/vertex_stiffness.hpp"

namespace greenloop::offline {
namespace {

constexpr double kNoWeight = 1.0e-9;
constexpr double kLeastSum = 1.0e-3;  // of a vertex's weights, below which nothing depends on it
constexpr double kFarthest = -2.0;    // least barycentric coordinate to which a tetrahedron is continued
constexpr int kRings = 2;             // of cells in which one of the same matter is looked for

/// Vertices of a mesh, what moves and how stiff they are.
struct Level {
  const TetrahedralMesh* mesh;
  FreeVertices free;
  VertexStiffness stiffness;
};

bool follows(const Level& fine, int v, const Level& coarse, int w) {
  return fine.stiffness.follows(static_cast<std::uint32_t>(v), coarse.stiffness, static_cast<std::uint32_t>(w));
}

/// Where a vertex hangs: in the tetrahedron around it, unless one of its own matter is near.
Barycentric place(const Level& fine, int v, const Level& coarse, const TetrahedronGrid& grid) {
  const Eigen::Vector3d& point = fine.mesh->vertices[v];
  const Barycentric around = grid.nearest(point);
  const auto& corners = coarse.mesh->tetrahedra[around.tetrahedron];
  bool fits = true;
  for (Eigen::Index a = 0; a < 4; ++a) {
    fits = fits && (std::abs(around.coordinate[a]) < kNoWeight || follows(fine, v, coarse, corners[a]));
  }
  if (fits) return around;
  const auto own = grid.nearest(point, kRings, [&](std::uint32_t t) {
    for (const int w : coarse.mesh->tetrahedra[t]) {
      if (!follows(fine, v, coarse, w)) return false;
    }
    return true;
  });
  return own && own->least() >= kFarthest ? *own : around;
}

std::vector<Barycentric> places(const Level& fine, const Level& coarse, const TetrahedronGrid& grid) {
  std::vector<Barycentric> result;
  for (int v = 0; v < static_cast<int>(fine.free.number.size()); ++v) {
    if (fine.free.number[v] >= 0) result.push_back(place(fine, v, coarse, grid));
  }
  return result;
}

/// Leaves out vertices on which hardly anything depends.
FreeVertices used(const Level& coarse, const std::vector<Barycentric>& places) {
  std::vector<double> sum(coarse.mesh->vertices.size(), 0.0);
  for (const Barycentric& place : places) {
    for (Eigen::Index a = 0; a < 4; ++a) {
      sum[coarse.mesh->tetrahedra[place.tetrahedron][a]] += std::abs(place.coordinate[a]);
    }
  }
  std::vector<std::uint8_t> unused(sum.size());
  for (std::size_t v = 0; v < sum.size(); ++v) unused[v] = coarse.free.number[v] < 0 || sum[v] < kLeastSum ? 1 : 0;
  return FreeVertices(unused);
}

Prolongation weights(const Level& coarse, const std::vector<Barycentric>& places) {
  Prolongation result;
  result.coarse = static_cast<std::uint32_t>(coarse.free.count);
  result.start.push_back(0);
  for (const Barycentric& place : places) {
    for (Eigen::Index a = 0; a < 4; ++a) {
      const int parent = coarse.free.number[coarse.mesh->tetrahedra[place.tetrahedron][a]];
      if (parent < 0 || std::abs(place.coordinate[a]) < kNoWeight) continue;
      result.parent.push_back(static_cast<std::uint32_t>(parent));
      result.weight.push_back(place.coordinate[a]);
    }
    result.start.push_back(static_cast<std::uint32_t>(result.parent.size()));
  }
  return result;
}

/// Holds the vertices around which most of the finest mesh is held.
FreeVertices free_where(const TetrahedralMesh& mesh, const TetrahedralMesh& finest, const FreeVertices& free,
                        const TetrahedronGrid& grid) {
  std::vector<std::uint8_t> held;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const Barycentric place = grid.nearest(vertex);
    double share = 0.0;
    for (Eigen::Index a = 0; a < 4; ++a) {
      if (free.number[finest.tetrahedra[place.tetrahedron][a]] < 0) share += place.coordinate[a];
    }
    held.push_back(share > 0.5 ? 1 : 0);
  }
  return FreeVertices(held);
}

}  // namespace

std::vector<Prolongation> prolongations(const TetrahedralMesh& finest, const FreeVertices& free,
                                        std::span<const double> young, std::span<const TetrahedralMesh> coarser) {
  const Matter matter(finest, young);
  const TetrahedronGrid finest_grid(finest);
  std::vector<Prolongation> result;
  Level fine{&finest, free, matter.at_vertices()};
  for (const TetrahedralMesh& mesh : coarser) {
    Level coarse{&mesh, free_where(mesh, finest, free, finest_grid), matter.at(mesh.vertices, finest_grid)};
    const TetrahedronGrid grid(mesh);
    const std::vector<Barycentric> hung = places(fine, coarse, grid);
    coarse.free = used(coarse, hung);
    if (coarse.free.count == 0) {
      throw std::invalid_argument("multigrid: no vertex of the coarser mesh of " +
                                  std::to_string(mesh.vertices.size()) + " vertices is free; leave that mesh out");
    }
    result.push_back(weights(coarse, hung));
    fine = {&mesh, std::move(coarse.free), std::move(coarse.stiffness)};
  }
  return result;
}

}  // namespace greenloop::offline
