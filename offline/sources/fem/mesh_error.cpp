#include "offline/sources/fem/mesh_error.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <queue>
#include <set>
#include <utility>

#include "offline/sources/fem/held_body.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t patch_vertices = 64, spread_patches = 16, solved_patches = 3;

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// the boundary of a volume, by vertex of the volume
struct Skin {
  std::vector<std::vector<int>> neighbours;  // empty inside
  std::vector<std::uint8_t> pressable;       // free, and a touched node hangs on it
  std::set<std::array<int, 2>> edges;        // the lower vertex first
};

Skin make_skin(const FemProblem& problem, std::span<const int> touched) {
  Skin skin;
  skin.neighbours.resize(problem.volume.vertices.size());
  skin.pressable.resize(problem.volume.vertices.size(), 0);
  const Boundary boundary = extract_boundary(problem.volume);
  for (const auto& triangle : boundary.surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = boundary.volume_vertex[triangle[k]], b = boundary.volume_vertex[triangle[(k + 1) % 3]];
      if (skin.edges.insert({std::min(a, b), std::max(a, b)}).second) {
        skin.neighbours[a].push_back(b);
        skin.neighbours[b].push_back(a);
      }
    }
  }
  for (const int node : touched) {
    for (Interpolation::InnerIterator it(problem.interpolation, node); it; ++it) {
      const auto vertex = static_cast<std::size_t>(it.col());
      if (it.value() > 1e-9 && problem.fixed[vertex] == 0) skin.pressable[vertex] = 1;
    }
  }
  return skin;
}

double distance(const FemProblem& problem, int a, int b) {
  return (problem.volume.vertices[a] - problem.volume.vertices[b]).norm();
}

// pressable vertices that are far from each other, each the farthest from those before
std::vector<int> spread_centers(const FemProblem& problem, const Skin& skin) {
  std::vector<int> centers;
  std::vector<double> nearest(skin.pressable.size(), std::numeric_limits<double>::max());
  const auto first = std::find(skin.pressable.begin(), skin.pressable.end(), 1);
  for (int next = static_cast<int>(first - skin.pressable.begin());
       centers.size() < spread_patches && static_cast<std::size_t>(next) < nearest.size() && nearest[next] > 0;) {
    centers.push_back(next);
    for (std::size_t v = 0; v < nearest.size(); ++v) {
      const int vertex = static_cast<int>(v);
      nearest[v] = skin.pressable[v] == 0 ? 0 : std::min(nearest[v], distance(problem, vertex, centers.back()));
    }
    next = static_cast<int>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  return centers;
}

// the vertices nearest to one along the surface's edges
std::vector<int> patch_around(const FemProblem& problem, const Skin& skin, int center) {
  using Reached = std::pair<double, int>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
  std::vector<int> patch;
  std::vector<std::uint8_t> done(skin.pressable.size(), 0);
  queue.emplace(0, center);
  while (!queue.empty() && patch.size() < patch_vertices) {
    const auto [length, vertex] = queue.top();
    queue.pop();
    if (done[vertex] != 0) continue;
    done[vertex] = 1;
    patch.push_back(vertex);
    for (const int neighbour : skin.neighbours[vertex]) {
      if (skin.pressable[neighbour] != 0 && done[neighbour] == 0) {
        queue.emplace(length + distance(problem, vertex, neighbour), neighbour);
      }
    }
  }
  return patch;
}

// linear elements with a patch held
class HeldPatch {
 public:
  HeldPatch(std::vector<int> vertices, const FreeVertices& free, Factorization& factors)
      : vertices_(std::move(vertices)), free_(free) {
    std::vector<Eigen::Triplet<double>> unit;
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const int column = 3 * static_cast<int>(i) + axis;
        unit.emplace_back(3 * free.number[vertices_[i]] + axis, column, 1.0);
      }
    }
    Eigen::SparseMatrix<double> forces(Index{3} * free.count, 3 * static_cast<Index>(vertices_.size()));
    forces.setFromTriplets(unit.begin(), unit.end());
    factors.solve(forces, column_);
    compliance_.compute(at_patch(column_));
  }

  [[nodiscard]] const std::vector<int>& vertices() const { return vertices_; }

  // the displacement with the patch displaced by one along an axis, by free vertex
  [[nodiscard]] VectorXd displaced(int axis) const {
    VectorXd held = VectorXd::Zero(column_.cols());
    for (Index i = axis; i < held.size(); i += 3) held[i] = 1;
    return column_ * compliance_.solve(held);
  }

 private:
  [[nodiscard]] MatrixXd at_patch(const MatrixXd& all) const {
    MatrixXd here(3 * static_cast<Index>(vertices_.size()), all.cols());
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      here.middleRows<3>(3 * static_cast<Index>(i)) = all.middleRows<3>(Index{3} * free_.number[vertices_[i]]);
    }
    return here;
  }

  std::vector<int> vertices_;
  const FreeVertices& free_;
  MatrixXd column_;  // displacements by unit forces on the patch
  Eigen::LLT<MatrixXd> compliance_;
};

// what a body is solved on again
struct QuadraticBody {
  const FemProblem& problem;
  FreeVertices free;
  Factorization factors;
  Skin skin;
  MeshEdges edges;
  QuadraticStiffness stiffness;
  std::vector<Eigen::LLT<Eigen::Matrix3d>> edge_block;
  std::vector<std::uint8_t> fixed_edge;

  QuadraticBody(const FemProblem& of, std::span<const int> touched)
      : problem(of),
        free(of.fixed),
        factors(assemble_stiffness(of.volume, of.material, free), 3),
        skin(make_skin(of, touched)),
        edges(list_edges(of.volume)),
        stiffness(of.volume, edges, of.material) {
    for (const auto& block : stiffness.edge_blocks()) edge_block.emplace_back(block);
    FemProblem quadratic = of;
    quadratic.elements = Elements::quadratic;
    for (const int number : free_points(quadratic, edges).edge) fixed_edge.push_back(number < 0 ? 1 : 0);
  }

  [[nodiscard]] Matrix3Xd by_vertex(const VectorXd& of_free) const {
    Matrix3Xd all = Matrix3Xd::Zero(3, static_cast<Index>(free.number.size()));
    for (std::size_t v = 0; v < free.number.size(); ++v) {
      if (free.number[v] >= 0) all.col(static_cast<Index>(v)) = of_free.segment<3>(Index{3} * free.number[v]);
    }
    return all;
  }
};

// the patch, what is fixed, and the edges of the skin between two vertices of either
Held held_with(const QuadraticBody& body, const std::vector<int>& patch) {
  Held held{body.problem.fixed, body.fixed_edge};
  std::vector<std::uint8_t> in_patch(body.free.number.size(), 0);
  for (const int vertex : patch) in_patch[vertex] = held.vertices[vertex] = 1;
  for (std::size_t e = 0; e < held.edges.size(); ++e) {
    const auto& [a, b] = body.edges.ends[e];
    if (in_patch[a] != 0 && in_patch[b] != 0 && body.skin.edges.contains({a, b})) held.edges[e] = 1;
  }
  return held;
}

// energy that the edges would release which are not held, each by itself
double released_one_by_one(const QuadraticBody& body, const Held& held, const Matrix3Xd& force) {
  double released = 0;
  for (std::size_t e = 0; e < held.edges.size(); ++e) {
    const Vector3d pull = force.col(static_cast<Index>(e));
    if (held.edges[e] == 0) released += pull.dot(body.edge_block[e].solve(pull));
  }
  return released;
}

// a patch that might be solved again
struct Candidate {
  std::vector<int> vertices;  // the first is its center
  double released = 0;        // largest share of the energy that edges release which move one by one
};

double released_by_edges(const QuadraticBody& body, const HeldPatch& patch) {
  const Held held = held_with(body, patch.vertices());
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    QuadraticField moved = body.stiffness.zero();
    moved.vertex = body.by_vertex(patch.displaced(axis));
    const QuadraticField force = body.stiffness.force(moved);
    const double energy = moved.vertex.cwiseProduct(force.vertex).sum();
    largest = std::max(largest, released_one_by_one(body, held, force.edge) / energy);
  }
  return largest;
}

// different patches, the worst first
std::vector<Candidate> rank_patches(QuadraticBody& body, const MeshErrorProgress& progress) {
  std::vector<Candidate> candidates;
  std::set<std::vector<int>> seen;
  const std::vector<int> centers = spread_centers(body.problem, body.skin);
  for (std::size_t c = 0; c < centers.size(); ++c) {
    if (progress) progress(0.5 * static_cast<double>(c) / static_cast<double>(centers.size()));
    Candidate candidate{patch_around(body.problem, body.skin, centers[c])};
    std::vector<int> sorted = candidate.vertices;
    std::sort(sorted.begin(), sorted.end());
    if (!seen.insert(std::move(sorted)).second) continue;
    candidate.released = released_by_edges(body, HeldPatch(candidate.vertices, body.free, body.factors));
    candidates.push_back(std::move(candidate));
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.released > b.released; });
  return candidates;
}

// forces that displace patches by one, with quadratic elements as a source solves them
class QuadraticSource {
 public:
  QuadraticSource(const FemProblem& problem, const std::vector<Candidate>& patches)
      : vertices_(vertices_of(patches)),
        every_vertex_(select_first_vertices(static_cast<int>(problem.volume.vertices.size()),
                                            static_cast<int>(problem.volume.vertices.size()))),
        source_({problem.volume, problem.fixed, every_vertex_, problem.material, vertices_, vertices_,
                 Elements::quadratic}) {}

  [[nodiscard]] std::array<double, 3> forces(const std::vector<int>& patch) {
    std::vector<int> columns;
    for (const int vertex : patch) {
      columns.push_back(
          static_cast<int>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) - vertices_.begin()));
    }
    const MatrixXd displacement = source_.read(columns);
    MatrixXd compliance(displacement.cols(), displacement.cols());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      compliance.middleRows<3>(3 * static_cast<Index>(i)) = displacement.middleRows<3>(Index{3} * columns[i]);
    }
    const MatrixXd whole = Eigen::Matrix3d::Identity().replicate(static_cast<Index>(columns.size()), 1);
    const Vector3d force = (whole.transpose() * compliance.llt().solve(whole)).diagonal();
    return {force.x(), force.y(), force.z()};
  }

 private:
  static std::vector<int> vertices_of(const std::vector<Candidate>& patches) {
    std::set<int> all;
    for (const auto& patch : patches) all.insert(patch.vertices.begin(), patch.vertices.end());
    return {all.begin(), all.end()};
  }

  std::vector<int> vertices_;
  Interpolation every_vertex_;
  FemSource source_;
};

}  // namespace

MeshError estimate_mesh_error(const FemProblem& problem, std::span<const int> touched,
                              const MeshErrorProgress& progress) {
  QuadraticBody body(problem, touched);
  MeshError error;
  std::vector<Candidate> worst = rank_patches(body, progress);
  worst.resize(std::min(worst.size(), solved_patches));
  std::optional<QuadraticSource> own;
  if (problem.elements == Elements::quadratic && !worst.empty()) own.emplace(problem, worst);
  for (std::size_t k = 0; k < worst.size(); ++k) {
    const std::vector<int>& patch = worst[k].vertices;
    const auto around = tetrahedra_around(problem.volume, patch);
    const auto own_forces = own ? own->forces(patch) : std::array<double, 3>{};
    HeldBody whole(problem.volume, body.edges, problem.material, held_with(body, patch));
    for (int axis = 0; axis < 3; ++axis) {
      if (progress) progress(0.5 + static_cast<double>(3 * k + axis) / static_cast<double>(6 * worst.size()));
      QuadraticField displacement = body.stiffness.zero();
      for (const int vertex : patch) displacement.vertex(axis, vertex) = 1;
      const HeldForces forces = held_forces(whole, displacement, around);
      error.patches.push_back({.center = problem.volume.vertices[patch.front()],
                               .axis = axis,
                               .own_force = own ? own_forces[axis] : forces.linear,
                               .linear_force = forces.linear,
                               .quadratic_force = forces.quadratic,
                               .limit_force = forces.extrapolated});
      error.settled = error.settled && forces.settled;
    }
  }
  std::sort(error.patches.begin(), error.patches.end(),
            [](const PressedPatch& a, const PressedPatch& b) { return a.error() > b.error(); });
  return error;
}

}  // namespace greenloop::offline
