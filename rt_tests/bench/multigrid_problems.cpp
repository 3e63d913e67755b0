#include "rt_tests/bench/multigrid_problems.hpp"

#include <Eigen/LU>
#include <cmath>
#include <map>
#include <tuple>

#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::bench {
namespace {

using Eigen::Vector3d;

constexpr double kWeight = 1000.0;    // N/m^3
constexpr double kNetgenRatio = 1.8;  // of one level's edges to the next finer one's
constexpr int kCoarsestCells = 5;     // along an edge, at most

TetrahedralMesh halved_cells(int cells) {
  return offline::testing::box(Eigen::Vector3i::Constant(cells), Vector3d::Ones());
}

/// The surface of a cube, each side in squares cut in two.
TriangleMesh surface_of_cube(int cells) {
  TriangleMesh mesh;
  std::map<std::tuple<int, int, int>, int> number;
  const auto vertex = [&](const Eigen::Vector3i& at) {
    const auto [entry, fresh] = number.try_emplace({at.x(), at.y(), at.z()}, static_cast<int>(number.size()));
    if (fresh) mesh.vertices.emplace_back(at.cast<double>() / cells);
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, cells}) {
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          const auto corner = [&](int di, int dj) {
            Eigen::Vector3i at;
            at[axis] = side;
            at[(axis + 1) % 3] = i + di;
            at[(axis + 2) % 3] = j + dj;
            return vertex(at);
          };
          const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == 0) {
            mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {a, d, c}});
          } else {
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
          }
        }
      }
    }
  }
  return mesh;
}

TetrahedralMesh by_netgen(int cells) {
  return offline::tetrahedralize(surface_of_cube(cells), {.interior_growth = 1.0}).mesh;
}

bool is_stiff(StiffPart part, const Vector3d& p) {
  if (part == StiffPart::ball) return (p - Vector3d(0.5, 0.5, 0.5)).norm() < 0.3;
  const Eigen::Vector3i cell = (4 * p).cast<int>();
  return part == StiffPart::checkerboard && cell.sum() % 2 != 0;
}

std::string name_of(Meshes meshes, StiffPart part) {
  const std::string what = part == StiffPart::none   ? "homogeneous"
                           : part == StiffPart::ball ? "stiff ball"
                                                     : "checkerboard";
  return meshes == Meshes::netgen ? what + ", unstructured" : what;
}

}  // namespace

offline::SolidMatter MultigridProblem::matter() const {
  offline::SolidMatter result{{{{1.0, poisson}, 0.0}, {{contrast, poisson}, 0.0}}, {}};
  for (const auto& t : mesh.tetrahedra) {
    Vector3d middle = Vector3d::Zero();
    for (const int v : t) middle += mesh.vertices[v] / 4.0;
    result.kind.push_back(is_stiff(part, middle) ? 1 : 0);
  }
  return result;
}

offline::FreeVertices MultigridProblem::free() const {
  std::vector<std::uint8_t> fixed;
  for (const Vector3d& vertex : mesh.vertices) fixed.push_back(vertex.x() < 1e-9 ? 1 : 0);
  return offline::FreeVertices(fixed);
}

offline::BlockVector MultigridProblem::weight() const {
  const offline::FreeVertices moves = free();
  offline::BlockVector b(static_cast<std::size_t>(moves.count));
  for (const auto& t : mesh.tetrahedra) {
    Eigen::Matrix3d edges;
    for (int a = 0; a < 3; ++a) edges.col(a) = mesh.vertices[t[a + 1]] - mesh.vertices[t[0]];
    const double share = kWeight * edges.determinant() / 24.0;
    for (const int v : t) {
      if (moves.number[v] >= 0) b[moves.number[v]][2] -= share;
    }
  }
  return b;
}

MultigridProblem multigrid_problem(Meshes meshes, int cells, StiffPart part, double contrast, double poisson) {
  const bool netgen = meshes == Meshes::netgen;
  const auto mesh_of = netgen ? by_netgen : halved_cells;
  MultigridProblem problem{name_of(meshes, part), part, contrast, poisson, mesh_of(cells), {}};
  for (int level = cells; level > kCoarsestCells;) {
    level = netgen ? static_cast<int>(std::lround(level / kNetgenRatio)) : (level + 1) / 2;
    problem.coarser.push_back(mesh_of(level));
  }
  return problem;
}

}  // namespace greenloop::bench
