#include "offline/multigrid/prolongations.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>

#include "offline/multigrid/tetrahedron_grid.hpp"
#include "offline/multigrid/vertex_stiffness.hpp"

namespace greenloop::offline {
namespace {

constexpr double kNoWeight = 1.0e-9;
constexpr double kLeastSum = 1.0e-3;  // of a vertex's weights, below which nothing depends on it
constexpr double kFarthest = -1.0;    // least barycentric coordinate to which a tetrahedron is continued
constexpr int kRings = 2;             // of cells in which one of the same matter is looked for

/// Vertices of a mesh, what moves and how stiff they are.
struct Level {
  const TetrahedralMesh* mesh;
  FreeVertices free;
  VertexStiffness stiffness;
};

/// Where a vertex hangs among the vertices of a coarser level.
struct Place {
  std::array<int, 4> parent;
  Eigen::Vector4d weight;
};

Place place_in(const TetrahedralMesh& mesh, const Barycentric& at) {
  return {mesh.tetrahedra[at.tetrahedron], at.coordinate};
}

bool follows(const Level& fine, int v, const Level& coarse, int w) {
  return fine.stiffness.follows(static_cast<std::uint32_t>(v), coarse.stiffness, static_cast<std::uint32_t>(w));
}

/// What moves and how stiff it is at the vertices of `mesh`: as at the nearest finer vertex of those in the tetrahedra
/// around. What has none of these is held; nothing depends on it.
Level level_of(const TetrahedralMesh& mesh, const Level& fine, const std::vector<Barycentric>& around) {
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> nearest(mesh.vertices.size(), none);
  for (std::size_t v = 0; v < around.size(); ++v) {
    const auto distance = [&](int w, std::size_t to) {
      return (fine.mesh->vertices[to] - mesh.vertices[w]).squaredNorm();
    };
    for (const int w : mesh.tetrahedra[around[v].tetrahedron]) {
      if (nearest[w] == none || distance(w, v) < distance(w, nearest[w])) nearest[w] = v;
    }
  }
  std::vector<std::uint8_t> held;
  VertexStiffness stiffness;
  for (const std::size_t v : nearest) {
    held.push_back(v == none || fine.free.number[v] < 0 ? 1 : 0);
    stiffness.young.push_back(v == none ? 1.0 : fine.stiffness.young[v]);
    stiffness.piece.push_back(v == none ? 0 : fine.stiffness.piece[v]);
  }
  return {&mesh, FreeVertices(held), std::move(stiffness)};
}

/// Where a vertex hangs: in the tetrahedron around it, unless that is of other matter and one of its own is near. None
/// if neither is.
std::optional<Place> place(const Level& fine, int v, const Barycentric& around, const Level& coarse,
                           const TetrahedronGrid& grid) {
  const auto& corners = coarse.mesh->tetrahedra[around.tetrahedron];
  bool fits = true;
  for (Eigen::Index a = 0; a < 4; ++a) {
    fits = fits && (std::abs(around.coordinate[a]) < kNoWeight || follows(fine, v, coarse, corners[a]));
  }
  if (fits) return place_in(*coarse.mesh, around);
  const auto own = grid.nearest(fine.mesh->vertices[v], kRings, [&](std::uint32_t t) {
    for (const int w : coarse.mesh->tetrahedra[t]) {
      if (!follows(fine, v, coarse, w)) return false;
    }
    return true;
  });
  if (!own || own->least() < kFarthest) return std::nullopt;
  return place_in(*coarse.mesh, *own);
}

/// Four of some points that span as much as they do: each the farthest from the flat through those before it.
std::array<std::size_t, 4> corners_of(std::span<const Eigen::Vector3d> points) {
  std::array<std::size_t, 4> corner{};
  Eigen::Matrix3d across = Eigen::Matrix3d::Identity();
  for (std::size_t a = 1; a < 4; ++a) {
    double most = -1.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = (across * (points[i] - points[corner[0]])).squaredNorm();
      if (distance > most) {
        most = distance;
        corner[a] = i;
      }
    }
    const Eigen::Vector3d direction = (across * (points[corner[a]] - points[corner[0]])).stableNormalized();
    across -= direction * direction.transpose();
  }
  return corner;
}

/// Weights of four points that give an affine function at a fifth of their flat, least in square where they are many.
Eigen::Vector4d affine_weights(const Eigen::Matrix<double, 3, 4>& corner, const Eigen::Vector3d& point) {
  const double size = (corner.colwise() - corner.col(0)).norm();
  Eigen::Matrix4d system = Eigen::Matrix4d::Ones();
  system.topRows<3>() = (corner.colwise() - corner.col(0)) / size;
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix4d> solver;
  solver.setThreshold(1.0e-6);
  solver.compute(system);
  Eigen::Vector4d right;
  right << (point - corner.col(0)) / size, 1.0;
  return solver.solve(right);
}

/// Parts of a piece for which the coarser mesh has no room go to the coarser level themselves: four of their vertices,
/// on which the others hang.
class Guests {
 public:
  Guests(const Level& fine, TetrahedralMesh& mesh, Level& coarse) : fine_(fine), mesh_(mesh), coarse_(coarse) {}

  void bring(const std::vector<int>& part, std::vector<std::optional<Place>>& places) {
    if (part.size() <= 4) {
      for (const int v : part) {
        const int w = add(v);
        places[v] = Place{{w, w, w, w}, Eigen::Vector4d::UnitX()};
      }
      return;
    }
    std::vector<Eigen::Vector3d> points;
    points.reserve(part.size());
    for (const int v : part) points.push_back(fine_.mesh->vertices[v]);
    std::array<int, 4> parent{};
    Eigen::Matrix<double, 3, 4> corner;
    const auto chosen = corners_of(points);
    for (std::size_t a = 0; a < 4; ++a) {
      corner.col(static_cast<Eigen::Index>(a)) = points[chosen[a]];
      parent[a] = add(part[chosen[a]]);
    }
    for (std::size_t i = 0; i < part.size(); ++i) places[part[i]] = Place{parent, affine_weights(corner, points[i])};
  }

 private:
  int add(int v) {
    mesh_.vertices.push_back(fine_.mesh->vertices[v]);
    coarse_.free.number.push_back(coarse_.free.count++);
    coarse_.stiffness.young.push_back(fine_.stiffness.young[v]);
    coarse_.stiffness.piece.push_back(fine_.stiffness.piece[v]);
    return static_cast<int>(mesh_.vertices.size()) - 1;
  }

  const Level& fine_;
  TetrahedralMesh& mesh_;
  Level& coarse_;
};

/// Where each vertex hangs, of those that are free. Adds guests to the coarser level, and to its mesh their vertices.
std::vector<std::optional<Place>> places(const Level& fine, const std::vector<Barycentric>& around,
                                         const TetrahedronGrid& grid, TetrahedralMesh& mesh, Level& coarse) {
  std::vector<std::optional<Place>> result(around.size());
  using Part = std::tuple<std::uint32_t, std::size_t>;  // piece and place
  std::map<Part, std::vector<int>> parts;
  for (int v = 0; v < static_cast<int>(around.size()); ++v) {
    if (fine.free.number[v] < 0) continue;
    result[v] = place(fine, v, around[v], coarse, grid);
    if (!result[v]) parts[{fine.stiffness.piece[v], grid.region(fine.mesh->vertices[v])}].push_back(v);
  }
  Guests guests(fine, mesh, coarse);
  for (const auto& [which, part] : parts) guests.bring(part, result);
  return result;
}

/// Leaves out vertices on which hardly anything depends.
FreeVertices used(const Level& coarse, const std::vector<std::optional<Place>>& places) {
  std::vector<double> sum(coarse.mesh->vertices.size(), 0.0);
  for (const auto& place : places) {
    if (!place) continue;
    for (std::size_t a = 0; a < 4; ++a) sum[place->parent[a]] += std::abs(place->weight[static_cast<Eigen::Index>(a)]);
  }
  std::vector<std::uint8_t> unused(sum.size());
  for (std::size_t v = 0; v < sum.size(); ++v) unused[v] = coarse.free.number[v] < 0 || sum[v] < kLeastSum ? 1 : 0;
  return FreeVertices(unused);
}

Prolongation weights(const Level& coarse, const std::vector<std::optional<Place>>& places) {
  Prolongation result;
  result.coarse = static_cast<std::uint32_t>(coarse.free.count);
  result.start.push_back(0);
  for (const auto& place : places) {
    if (!place) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      const double weight = place->weight[static_cast<Eigen::Index>(a)];
      const int parent = coarse.free.number[place->parent[a]];
      if (parent < 0 || std::abs(weight) < kNoWeight) continue;
      result.parent.push_back(static_cast<std::uint32_t>(parent));
      result.weight.push_back(weight);
    }
    result.start.push_back(static_cast<std::uint32_t>(result.parent.size()));
  }
  return result;
}

}  // namespace

std::vector<Prolongation> prolongations(const TetrahedralMesh& finest, const FreeVertices& free,
                                        std::span<const double> young, std::span<const TetrahedralMesh> coarser) {
  std::vector<TetrahedralMesh> meshes(coarser.begin(), coarser.end());
  std::vector<Prolongation> result;
  Level fine{&finest, free, vertex_stiffness(finest, young)};
  for (TetrahedralMesh& mesh : meshes) {
    const TetrahedronGrid grid(mesh);
    std::vector<Barycentric> around;
    around.reserve(fine.mesh->vertices.size());
    for (const Eigen::Vector3d& vertex : fine.mesh->vertices) around.push_back(grid.nearest(vertex));
    Level coarse = level_of(mesh, fine, around);
    const auto hung = places(fine, around, grid, mesh, coarse);
    coarse.free = used(coarse, hung);
    if (coarse.free.count == 0) {
      throw std::invalid_argument("multigrid: no vertex of the coarser mesh of " +
                                  std::to_string(mesh.vertices.size()) + " vertices is free; leave that mesh out");
    }
    result.push_back(weights(coarse, hung));
    fine = std::move(coarse);
  }
  return result;
}

}  // namespace greenloop::offline
