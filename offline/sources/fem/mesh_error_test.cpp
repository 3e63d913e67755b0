#include "offline/sources/fem/mesh_error.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/sources/fem/quadratic_elements.hpp"
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

TEST_CASE("the mesh error of a pressed block is within a factor of 2 of the true one, and falls with the mesh") {
  for (const double poisson : {0.3, 0.45, 0.49}) {
    const MeshError coarse = Block(1).error(poisson), fine = Block(3).error(poisson);
    REQUIRE(coarse.patches.size() == 3);  // one patch, along each axis
    CHECK(coarse.settled);
    CHECK(fine.settled);
    for (int axis = 0; axis < 3; ++axis) {
      const double truth = along(coarse, axis).linear_force / along(fine, axis).quadratic_force - 1;
      MESSAGE("nu = ", poisson, ", axis ", axis, ": estimated ", along(coarse, axis).error(), ", true ", truth,
              "; on a finer mesh ", along(fine, axis).error());
      CHECK(along(coarse, axis).error() < 1.1 * truth);
      CHECK(along(coarse, axis).error() > 0.5 * truth);
      CHECK(along(fine, axis).error() < along(coarse, axis).error());
    }
    CHECK(coarse.force() == coarse.patches.front().error());
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
