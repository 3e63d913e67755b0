#include "offline/multigrid/coarsen.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "offline/remesh/self_parameterization.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t kFewestSurfaceVertices = 12;

using Cell = std::tuple<int, int, int>;

struct Box {
  Eigen::Vector3d low, high;
};

Box box_of(const TetrahedralMesh& mesh) {
  Box box{mesh.vertices.at(0), mesh.vertices.at(0)};
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    box.low = box.low.cwiseMin(vertex);
    box.high = box.high.cwiseMax(vertex);
  }
  return box;
}

double mean_edge(const TetrahedralMesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.tetrahedra) sum += (mesh.vertices[t[1]] - mesh.vertices[t[0]]).norm();
  return sum / static_cast<double>(mesh.tetrahedra.size());
}

double determinant(const TetrahedralMesh& mesh, const std::array<int, 4>& t) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.col(a) = mesh.vertices[t[a + 1]] - mesh.vertices[t[0]];
  return edges.determinant();
}

void add(TetrahedralMesh& mesh, std::array<int, 4> t) {
  if (determinant(mesh, t) < 0.0) std::swap(t[2], t[3]);
  mesh.tetrahedra.push_back(t);
}

TriangleMesh decimated(const TriangleMesh& surface) {
  SelfParameterization base = decimate(surface, static_cast<int>(surface.vertices.size() / 4));
  return {std::move(base.base_vertices), std::move(base.base_triangles)};
}

/// Meshes of decimated surfaces while that succeeds, and why it did not.
std::string add_meshed(TriangleMesh surface, std::size_t vertices, std::size_t coarsest,
                       std::vector<TetrahedralMesh>& meshes) {
  while (vertices > coarsest && surface.vertices.size() / 4 >= kFewestSurfaceVertices) {
    if (vertices < 4 * surface.vertices.size()) surface = decimated(surface);
    TetrahedralMesh mesh;
    try {
      mesh = tetrahedralize(surface).mesh;
    } catch (const std::exception& refusal) {
      return refusal.what();
    }
    if (2 * mesh.vertices.size() > vertices) return "the mesher adds as many vertices as the surface lost";
    vertices = mesh.vertices.size();
    meshes.push_back(std::move(mesh));
  }
  return {};
}

}  // namespace

CoarserMeshes coarsen(const TriangleMesh& surface, const TetrahedralMesh& finest, std::size_t coarsest) {
  CoarserMeshes result;
  const std::string refusal = add_meshed(surface, finest.vertices.size(), coarsest, result.meshes);
  const auto last = [&]() -> const TetrahedralMesh& { return result.meshes.empty() ? finest : result.meshes.back(); };
  if (!refusal.empty()) {
    result.note = "multigrid: below " + std::to_string(last().vertices.size()) + " vertices lattices: " + refusal;
  }
  for (double spacing = 2.0 * mean_edge(last()); last().vertices.size() > coarsest; spacing *= 2.0) {
    TetrahedralMesh next = lattice(finest, spacing);
    if (next.vertices.size() < last().vertices.size()) result.meshes.push_back(std::move(next));
  }
  return result;
}

TetrahedralMesh lattice(const TetrahedralMesh& mesh, double spacing) {
  const Box box = box_of(mesh);
  if (!(spacing > 1.0e-6 * (box.high - box.low).maxCoeff())) {
    throw std::invalid_argument("multigrid: a lattice of spacing " + std::to_string(spacing));
  }
  std::set<Cell> cells;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const Eigen::Vector3i at = ((vertex - box.low) / spacing).cast<int>();
    cells.insert({at.x(), at.y(), at.z()});
  }
  TetrahedralMesh result;
  std::map<Cell, int> number;
  const auto corner = [&](const Eigen::Vector3i& at) {
    const auto [entry, fresh] = number.try_emplace({at.x(), at.y(), at.z()}, static_cast<int>(number.size()));
    if (fresh) result.vertices.emplace_back(box.low + spacing * at.cast<double>());
    return entry->second;
  };
  for (const auto& [x, y, z] : cells) {
    std::array<int, 3> axes{0, 1, 2};
    do {
      Eigen::Vector3i at(x, y, z);
      std::array<int, 4> t{corner(at)};
      for (std::size_t s = 0; s < 3; ++s) {
        ++at[axes[s]];
        t[s + 1] = corner(at);
      }
      add(result, t);
    } while (std::next_permutation(axes.begin(), axes.end()));
  }
  return result;
}

TetrahedralMesh refined(const TetrahedralMesh& mesh) {
  TetrahedralMesh result{mesh.vertices, {}};
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [entry, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(result.vertices.size()));
    if (fresh) result.vertices.emplace_back((mesh.vertices[a] + mesh.vertices[b]) / 2.0);
    return entry->second;
  };
  for (const auto& [a, b, c, d] : mesh.tetrahedra) {
    const int ab = middle(a, b), ac = middle(a, c), ad = middle(a, d);
    const int bc = middle(b, c), bd = middle(b, d), cd = middle(c, d);
    for (const auto& t : {std::array{a, ab, ac, ad}, {b, ab, bc, bd}, {c, ac, bc, cd}, {d, ad, bd, cd}}) add(result, t);
    // the octahedron between: its diagonals, and what lies around each in order
    const std::array<std::array<int, 6>, 3> around{
        {{ab, cd, ac, bc, bd, ad}, {ac, bd, ab, ad, cd, bc}, {ad, bc, ab, ac, cd, bd}}};
    const auto length = [&](const std::array<int, 6>& way) {
      return (result.vertices[way[1]] - result.vertices[way[0]]).squaredNorm();
    };
    const auto& way = *std::min_element(around.begin(), around.end(),
                                        [&](const auto& p, const auto& q) { return length(p) < length(q); });
    for (std::size_t i = 0; i < 4; ++i) add(result, {way[0], way[1], way[2 + i], way[2 + (i + 1) % 4]});
  }
  return result;
}

}  // namespace greenloop::offline
