#include "offline/sources/fem/mesh_error.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "offline/sources/fem/held_body.hpp"
#include "offline/sources/fem/quadratic_elements.hpp"
#include "offline/sources/fem/refined_region.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// a quadratic displacement is what its corners have and, of every edge, what the middle is beside them
template <class Displacement>
QuadraticField sampled(const TetrahedralMesh& mesh, const MeshEdges& edges, Displacement displacement) {
  QuadraticField field{Eigen::Matrix3Xd(3, static_cast<Index>(mesh.vertices.size())),
                       Eigen::Matrix3Xd(3, static_cast<Index>(edges.ends.size()))};
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    field.vertex.col(static_cast<Index>(v)) = displacement(mesh.vertices[v]);
  }
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    const auto [a, b] = edges.ends[e];
    const Vector3d middle = displacement(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
    field.edge.col(static_cast<Index>(e)) = middle - 0.5 * (field.vertex.col(a) + field.vertex.col(b));
  }
  return field;
}

TEST_CASE("quadratic elements: the energy of a quadratic displacement is exact") {
  const auto mesh = testing::box({2, 3, 2}, {1, 1, 1});
  const MeshEdges edges = list_edges(mesh);
  const double young = 3, poisson = 0.3;
  const QuadraticStiffness stiffness(mesh, edges, {young, poisson});
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), mu = young / (2 * (1 + poisson));
  // u = (x^2, x y, 0): strains 2x, x, 0 and a shear of y; trace 3x
  const auto field = sampled(mesh, edges, [](const Vector3d& x) { return Vector3d(x.x() * x.x(), x.x() * x.y(), 0); });
  const double third = 1.0 / 3;
  const double exact = lambda * 9 * third + 2 * mu * (4 * third + third) + mu * third;
  CHECK(field.dot(stiffness.force(field)) == doctest::Approx(exact).epsilon(1e-12));

  // with no force inside where the stress is in balance: u = (x^2 - y^2, -2 x y, 0) has neither trace nor rotation of
  // it
  const auto balanced = sampled(
      mesh, edges, [](const Vector3d& x) { return Vector3d(x.x() * x.x() - x.y() * x.y(), -2 * x.x() * x.y(), 0); });
  const auto force = stiffness.force(balanced);
  const auto skin = extract_boundary(mesh).volume_vertex;
  std::vector<std::uint8_t> outside(mesh.vertices.size(), 0);
  for (const int v : skin) outside[v] = 1;
  CHECK(std::count(outside.begin(), outside.end(), 0) == 2);
  for (std::size_t v = 0; v < outside.size(); ++v) {
    if (outside[v] == 0) CHECK(force.vertex.col(static_cast<Index>(v)).norm() < 1e-13);
  }
  CHECK(force.vertex.norm() > 0.1);
}

TEST_CASE("quadratic elements without edges are linear ones") {
  const auto mesh = testing::box({3, 2, 2}, {1, 2, 3});
  const MeshEdges edges = list_edges(mesh);
  const Material material{2, 0.45};
  const QuadraticStiffness stiffness(mesh, edges, material);
  QuadraticField field = stiffness.zero();
  for (Index i = 0; i < field.vertex.size(); ++i) field.vertex.data()[i] = std::sin(3.0 * static_cast<double>(i));
  const FreeVertices free(std::vector<std::uint8_t>(mesh.vertices.size(), 0));
  const Eigen::SparseMatrix<double> lower = assemble_stiffness(mesh, material, free);
  const Eigen::VectorXd force = lower.selfadjointView<Eigen::Lower>() *
                                Eigen::Map<const Eigen::VectorXd>(field.vertex.data(), field.vertex.size());
  const Eigen::Matrix3Xd got = stiffness.force(field).vertex;
  CHECK((Eigen::Map<const Eigen::VectorXd>(got.data(), got.size()) - force).norm() < 1e-12 * force.norm());

  // an edge's block is its stiffness with itself
  const auto blocks = stiffness.edge_blocks();
  for (const std::size_t e : {std::size_t{0}, blocks.size() / 2, blocks.size() - 1}) {
    for (int axis = 0; axis < 3; ++axis) {
      QuadraticField unit = stiffness.zero();
      unit.edge(axis, static_cast<Index>(e)) = 1;
      CHECK((stiffness.force(unit).edge.col(static_cast<Index>(e)) - blocks[e].col(axis)).norm() <
            1e-12 * blocks[e].norm());
    }
  }
}

TEST_CASE("tetrahedra that are split have the same displacement, and what is held stays held") {
  const auto mesh = testing::box({3, 2, 2}, {1, 2, 3});
  const MeshEdges edges = list_edges(mesh);
  QuadraticField field{Eigen::Matrix3Xd(3, static_cast<Index>(mesh.vertices.size())),
                       Eigen::Matrix3Xd(3, static_cast<Index>(edges.ends.size()))};
  for (Index i = 0; i < field.vertex.size(); ++i) field.vertex.data()[i] = std::sin(3.0 * static_cast<double>(i));
  for (Index i = 0; i < field.edge.size(); ++i) field.edge.data()[i] = std::cos(5.0 * static_cast<double>(i));
  const Material material{2, 0.45};
  std::vector<int> all(mesh.tetrahedra.size());
  std::iota(all.begin(), all.end(), 0);
  Held held{std::vector<std::uint8_t>(mesh.vertices.size()), std::vector<std::uint8_t>(edges.ends.size())};
  const auto below = [&](int v) { return mesh.vertices[v].z() == 0 ? std::uint8_t{1} : std::uint8_t{0}; };
  for (std::size_t v = 0; v < held.vertices.size(); ++v) held.vertices[v] = below(static_cast<int>(v));
  for (std::size_t e = 0; e < held.edges.size(); ++e) {
    held.edges[e] = below(edges.ends[e][0]) & below(edges.ends[e][1]);
  }
  const RefinedRegion whole = refine_region(mesh, edges, held, field, all);
  CHECK(whole.mesh.tetrahedra.size() == 8 * mesh.tetrahedra.size());
  CHECK(whole.mesh.vertices.size() == mesh.vertices.size() + edges.ends.size());
  const double energy = field.dot(QuadraticStiffness(mesh, edges, material).force(field));
  const auto split_energy = [&](const RefinedRegion& region) {
    return region.displacement.dot(QuadraticStiffness(region.mesh, region.edges, material).force(region.displacement));
  };
  CHECK(split_energy(whole) == doctest::Approx(energy).epsilon(1e-12));
  // 7 x 5 points lie below, and 6 x 5 + 7 x 4 + 6 x 4 edges between them
  CHECK(std::count(whole.held.vertices.begin(), whole.held.vertices.end(), 1) == 35);
  CHECK(std::count(whole.held.edges.begin(), whole.held.edges.end(), 1) == 82);

  // of a part, what the rest shares is held too, and the energies of two parts are that of the whole
  const std::span<const int> numbers(all);
  const RefinedRegion first = refine_region(mesh, edges, held, field, numbers.first(30)),
                      second = refine_region(mesh, edges, held, field, numbers.subspan(30));
  CHECK(split_energy(first) + split_energy(second) == doctest::Approx(energy).epsilon(1e-12));
  CHECK(std::count(first.held.vertices.begin(), first.held.vertices.end(), 0) > 0);
  for (std::size_t a = 0; a < first.mesh.vertices.size(); ++a) {
    const auto& x = first.mesh.vertices[a];
    const auto shared = std::find(second.mesh.vertices.begin(), second.mesh.vertices.end(), x);
    if (shared != second.mesh.vertices.end()) CHECK(first.held.vertices[a] == 1);
  }
}

// a block on a table, touched in the middle of its upper side
struct Block {
  TetrahedralMesh mesh;
  std::vector<std::uint8_t> fixed;
  Interpolation interpolation;
  std::vector<int> nodes, touched;

  explicit Block(int cells) : mesh(testing::box({4 * cells, 4 * cells, 2 * cells}, {1, 1, 0.5})) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vector3d& x = mesh.vertices[v];
      fixed.push_back(x.z() == 0 ? 1 : 0);
      const bool middle = std::abs(x.x() - 0.5) < 0.2501 && std::abs(x.y() - 0.5) < 0.2501;
      if (x.z() == 0.5 && middle) touched.push_back(static_cast<int>(v));
    }
    nodes.resize(mesh.vertices.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    interpolation = select_first_vertices(static_cast<int>(nodes.size()), static_cast<int>(nodes.size()));
  }

  [[nodiscard]] MeshError error(double poisson) const {
    return estimate_mesh_error({mesh, fixed, interpolation, {1, poisson}, nodes, nodes}, touched);
  }
};

const PressedPatch& along(const MeshError& error, int axis) {
  const auto found = std::find_if(error.patches.begin(), error.patches.end(),
                                  [axis](const PressedPatch& patch) { return patch.axis == axis; });
  REQUIRE(found != error.patches.end());
  return *found;
}

TEST_CASE("the mesh error of a pressed block is near the true one, and falls with the mesh") {
  for (const double poisson : {0.3, 0.45, 0.49}) {
    const MeshError coarse = Block(1).error(poisson), fine = Block(3).error(poisson);
    REQUIRE(coarse.patches.size() == 3);  // one patch, along each axis
    CHECK(coarse.settled);
    CHECK(fine.settled);
    for (int axis = 0; axis < 3; ++axis) {
      const double truth = along(coarse, axis).linear_force / along(fine, axis).limit_force - 1;
      MESSAGE("nu = ", poisson, ", axis ", axis, ": estimated ", along(coarse, axis).error(), ", true ", truth,
              "; on a finer mesh ", along(fine, axis).error());
      CHECK(along(coarse, axis).error() < 1.25 * truth);
      CHECK(along(coarse, axis).error() > 0.8 * truth);
      CHECK(along(fine, axis).error() < along(coarse, axis).error());
      CHECK(along(coarse, axis).limit_force < along(coarse, axis).quadratic_force);
    }
    CHECK(coarse.force() == coarse.patches.front().error());
  }
}

TEST_CASE("the mesh error of a body whose free vertices are all held") {
  const auto mesh = testing::box({1, 1, 1}, {1, 1, 1});
  std::vector<std::uint8_t> fixed;
  std::vector<int> nodes, touched;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    fixed.push_back(mesh.vertices[v].z() == 0 ? 1 : 0);
    nodes.push_back(static_cast<int>(v));
    if (fixed.back() == 0) touched.push_back(static_cast<int>(v));
  }
  const auto interpolation = select_first_vertices(static_cast<int>(nodes.size()), static_cast<int>(nodes.size()));
  const MeshError error = estimate_mesh_error({mesh, fixed, interpolation, {1, 0.3}, nodes, nodes}, touched);
  REQUIRE(error.patches.size() == 3);
  for (const PressedPatch& patch : error.patches) {
    CHECK(patch.linear_force > patch.quadratic_force);
    CHECK(patch.quadratic_force > patch.limit_force);
    CHECK(patch.limit_force > 0);
  }
}

// vertices of the boundary that are held, the boundary's edges between them, and what is fixed
Held hold(const TetrahedralMesh& mesh, const MeshEdges& edges, const std::vector<std::uint8_t>& fixed,
          const std::vector<int>& vertices) {
  std::vector<std::uint8_t> held(mesh.vertices.size(), 0);
  for (const int v : vertices) held[v] = 1;
  std::set<std::array<int, 2>> skin;
  const Boundary boundary = extract_boundary(mesh);
  for (const auto& t : boundary.surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = boundary.volume_vertex[t[k]], b = boundary.volume_vertex[t[(k + 1) % 3]];
      skin.insert({std::min(a, b), std::max(a, b)});
    }
  }
  Held all{fixed, std::vector<std::uint8_t>(edges.ends.size(), 0)};
  for (const int v : vertices) all.vertices[v] = 1;
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    const auto [a, b] = edges.ends[e];
    const bool on_patch = held[a] != 0 && held[b] != 0 && skin.contains(edges.ends[e]);
    all.edges[e] = on_patch || (fixed[a] != 0 && fixed[b] != 0) ? 1 : 0;
  }
  return all;
}

// a gel pad 20 x 20 x 3 mm of 100 kPa, its lower side fixed, pressed by a square of 7.5 x 7.5 mm that sticks to it
HeldForces pressed_pad(const Eigen::Vector3i& cells, double poisson) {
  const auto mesh = testing::box(cells, {0.020, 0.020, 0.003});
  const MeshEdges edges = list_edges(mesh);
  std::vector<std::uint8_t> fixed;
  std::vector<int> pressed;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vector3d& x = mesh.vertices[v];
    fixed.push_back(x.z() == 0 ? 1 : 0);
    if (x.z() > 0.00299 && std::max(std::abs(x.x() - 0.01), std::abs(x.y() - 0.01)) < 0.00376) {
      pressed.push_back(static_cast<int>(v));
    }
  }
  QuadraticField displacement{Eigen::Matrix3Xd::Zero(3, static_cast<Index>(mesh.vertices.size())),
                              Eigen::Matrix3Xd::Zero(3, static_cast<Index>(edges.ends.size()))};
  for (const int v : pressed) displacement.vertex(2, v) = 1;
  HeldBody body(mesh, edges, {1e5, poisson}, hold(mesh, edges, fixed, pressed));
  return held_forces(body, displacement, tetrahedra_around(mesh, pressed));
}

TEST_CASE("the mesh error of a gel pad is near the true one") {
  // N/m: spectral elements of order 4, graded towards the punch's edge
  for (const auto& [poisson, exact] : {std::pair{0.45, 4.89e3}, std::pair{0.49, 6.59e3}}) {
    for (const Eigen::Vector3i& cells : {Eigen::Vector3i(16, 16, 2), Eigen::Vector3i(32, 32, 5)}) {
      const HeldForces forces = pressed_pad(cells, poisson);
      const double estimated = forces.linear / forces.extrapolated - 1, truth = forces.linear / exact - 1;
      MESSAGE("nu = ", poisson, ", ", cells.x(), " cells: estimated ", estimated, ", true ", truth,
              "; quadratic alone ", forces.linear / forces.quadratic - 1);
      CHECK(forces.settled);
      CHECK(estimated < 1.5 * truth);
      CHECK(estimated > 0.67 * truth);
    }
  }
}

// inside the facets of a sphere around the origin
double volume_within(const std::vector<Vector3d>& vertices, const std::vector<std::array<int, 3>>& triangles) {
  double volume = 0;
  for (const auto& [a, b, c] : triangles) volume += vertices[a].dot(vertices[b].cross(vertices[c])) / 6;
  return volume;
}

TEST_CASE("the mesh error of Lame's hollow sphere is near the true one") {
  // the cavity, radius 1 of 2, widened by 1: 4 pi / u(1) with u(1) under unit pressure, E = 1; as large as its facets
  for (const auto& [poisson, widened] :
       {std::pair{0.3, 0.8}, std::pair{0.45, 0.842857142857}, std::pair{0.49, 0.854285714286}}) {
    for (const int level : {2, 3}) {
      const auto mesh = testing::shell(level, level == 2 ? 4 : 8, 1, 2);
      const MeshEdges edges = list_edges(mesh);
      const SemiRegularMesh sphere = testing::ellipsoid(level, Vector3d::Ones());
      std::vector<int> cavity(sphere.positions.size());
      std::iota(cavity.begin(), cavity.end(), 0);
      QuadraticField displacement{Eigen::Matrix3Xd::Zero(3, static_cast<Index>(mesh.vertices.size())),
                                  Eigen::Matrix3Xd::Zero(3, static_cast<Index>(edges.ends.size()))};
      for (const int v : cavity) displacement.vertex.col(v) = mesh.vertices[v].normalized();
      HeldBody body(mesh, edges, {1, poisson},
                    hold(mesh, edges, std::vector<std::uint8_t>(mesh.vertices.size(), 0), cavity));
      const HeldForces forces = held_forces(body, displacement, tetrahedra_around(mesh, cavity));
      const double exact = 3 * volume_within(sphere.positions, triangles_of_level(sphere, level)) / widened;
      const double estimated = forces.linear / forces.extrapolated - 1, truth = forces.linear / exact - 1;
      MESSAGE("nu = ", poisson, ", level ", level, ": estimated ", estimated, ", true ", truth, "; quadratic alone ",
              forces.linear / forces.quadratic - 1);
      CHECK(estimated < 1.25 * truth);
      CHECK(estimated > 0.8 * truth);
    }
  }
}

TEST_CASE("conjugate gradients find what a dense solution of the quadratic elements gives") {
  const Block block(1);
  const double poisson = 0.4;
  const MeshError error = block.error(poisson);
  const MeshEdges edges = list_edges(block.mesh);
  const QuadraticStiffness stiffness(block.mesh, edges, {1, poisson});
  // held: what is fixed, and the patch; edges between two held vertices, which all lie on the skin here
  std::vector<std::uint8_t> pressed(block.mesh.vertices.size(), 0);
  for (const int v : block.touched) pressed[v] = 1;
  const Index vertices = static_cast<Index>(block.mesh.vertices.size()),
              count = vertices + static_cast<Index>(edges.ends.size());
  std::vector<Index> free;
  for (Index n = 0; n < count; ++n) {
    const auto same = [&](const std::vector<std::uint8_t>& set) {
      return n < vertices ? set[n] != 0
                          : set[edges.ends[n - vertices][0]] != 0 && set[edges.ends[n - vertices][1]] != 0;
    };
    for (Index axis = 0; axis < 3; ++axis) {
      if (!same(block.fixed) && !same(pressed)) free.push_back(3 * n + axis);
    }
  }
  const auto at = [&](QuadraticField& field, Index i) -> double& {
    return i < 3 * vertices ? field.vertex.data()[i] : field.edge.data()[i - 3 * vertices];
  };
  Eigen::MatrixXd matrix(free.size(), free.size());
  for (std::size_t j = 0; j < free.size(); ++j) {
    QuadraticField unit = stiffness.zero();
    at(unit, free[j]) = 1;
    QuadraticField force = stiffness.force(unit);
    for (std::size_t i = 0; i < free.size(); ++i)
      matrix(static_cast<Index>(i), static_cast<Index>(j)) = at(force, free[i]);
  }
  QuadraticField moved = stiffness.zero();
  for (const int v : block.touched) moved.vertex(2, v) = 1;
  QuadraticField pull = stiffness.force(moved);
  Eigen::VectorXd side(free.size());
  for (std::size_t i = 0; i < free.size(); ++i) side[static_cast<Index>(i)] = -at(pull, free[i]);
  const Eigen::VectorXd solution = matrix.llt().solve(side);
  for (std::size_t i = 0; i < free.size(); ++i) at(moved, free[i]) = solution[static_cast<Index>(i)];
  const double exact = moved.dot(stiffness.force(moved));
  CHECK(along(error, 2).quadratic_force == doctest::Approx(exact).epsilon(0.02));
  CHECK(along(error, 2).quadratic_force >= exact);  // from above, as any displacement is
}

}  // namespace
}  // namespace greenloop::offline
