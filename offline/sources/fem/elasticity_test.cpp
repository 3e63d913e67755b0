#include "offline/sources/fem/elasticity.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <stdexcept>

#include "offline/sources/fem/factorization.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/tetrahedra_quality.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::Vector3d;
using Eigen::VectorXd;

SparseMatrix<double> lower_stiffness_of_all(const TetrahedralMesh& mesh, const Material& material) {
  return assemble_stiffness(mesh, material, FreeVertices(std::vector<std::uint8_t>(mesh.vertices.size(), 0)));
}

SparseMatrix<double> full_stiffness(const TetrahedralMesh& mesh, const Material& material) {
  return lower_stiffness_of_all(mesh, material).selfadjointView<Eigen::Lower>();
}

template <typename Field>
VectorXd sample(const TetrahedralMesh& mesh, Field field) {
  VectorXd values(3 * static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    values.segment<3>(3 * static_cast<Eigen::Index>(v)) = field(mesh.vertices[v]);
  }
  return values;
}

VectorXd solve_one(const SparseMatrix<double>& lower, const VectorXd& force) {
  Factorization factors(lower, 3);
  MatrixXd displacement;
  factors.solve(force.sparseView(), displacement);
  return displacement;
}

TEST_CASE("patch test: a linear displacement leaves no force on any interior node") {
  const auto mesh = tetrahedralize(finest_surface(testing::ellipsoid(2, {1, 0.8, 0.6}))).mesh;
  const auto stiffness = full_stiffness(mesh, {1.0, 0.3});
  Eigen::Matrix3d gradient;
  gradient << 0.3, -0.2, 0.5, 0.7, 0.1, -0.4, 0.2, 0.6, -0.8;
  const VectorXd force =
      stiffness * sample(mesh, [&](const Vector3d& x) { return Vector3d(gradient * x + Vector3d(1, 2, 3)); });
  std::vector<char> boundary(mesh.vertices.size(), 0);
  for (const int v : extract_boundary(mesh).volume_vertex) boundary[v] = 1;
  double interior = 0.0, outside = 0.0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    double& largest = boundary[v] != 0 ? outside : interior;
    largest = std::max(largest, force.segment<3>(3 * static_cast<Eigen::Index>(v)).norm());
  }
  CHECK(outside > 1e-3);
  CHECK(interior < 1e-13 * outside);
}

TEST_CASE("patch test: fixed values of a linear field on the boundary give that field inside") {
  const auto mesh = testing::box({4, 3, 3}, {1.0, 0.7, 0.9});
  std::vector<std::uint8_t> fixed(mesh.vertices.size(), 0);
  for (const int v : extract_boundary(mesh).volume_vertex) fixed[v] = 1;
  const auto exact = sample(mesh, [](const Vector3d& x) { return Vector3d(x.y() - x.z(), 2 * x.x(), x.sum()); });
  const FreeVertices free(fixed);
  VectorXd boundary_values = exact;
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    if (fixed[v] == 0) boundary_values.segment<3>(3 * static_cast<Eigen::Index>(v)).setZero();
  }
  const VectorXd pull = full_stiffness(mesh, {2.0, 0.4}) * boundary_values;
  VectorXd force(Eigen::Index{3} * free.count), expected(force.size());
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    if (free.number[v] < 0) continue;
    force.segment<3>(Eigen::Index{3} * free.number[v]) = -pull.segment<3>(3 * static_cast<Eigen::Index>(v));
    expected.segment<3>(Eigen::Index{3} * free.number[v]) = exact.segment<3>(3 * static_cast<Eigen::Index>(v));
  }
  const VectorXd inside = solve_one(assemble_stiffness(mesh, {2.0, 0.4}, free), force);
  CHECK((inside - expected).norm() < 1e-13 * expected.norm());
}

TEST_CASE("an element has exactly six modes without energy, and a body's rigid motions cost no force") {
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, 1.1, 0.2, 0.1, 0, 0.1, 0.9, 0.3, 0, -0.2, 0.1, 1.3;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> modes(element_stiffness(corners, {3.0, 0.35}));
  const auto& values = modes.eigenvalues();
  CHECK(std::abs(values[0]) < 1e-14 * values[11]);
  CHECK(std::abs(values[5]) < 1e-14 * values[11]);
  CHECK(values[6] > 1e-3 * values[11]);

  const auto mesh = testing::box({3, 2, 2}, {1, 2, 3});
  const auto stiffness = full_stiffness(mesh, {1.0, 0.3});
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d e = Vector3d::Unit(axis);
    CHECK((stiffness * sample(mesh, [&](const Vector3d&) -> const Vector3d& { return e; })).norm() < 1e-13);
    CHECK((stiffness * sample(mesh, [&](const Vector3d& x) { return Vector3d(e.cross(x)); })).norm() < 1e-13);
  }
}

/// Mean radial displacement of the inner sphere of a shell 1..2 under unit inner pressure, E = 1.
double lame_inner_displacement(int levels, int layers, double poisson) {
  const auto mesh = testing::shell(levels, layers, 1.0, 2.0);
  auto stiffness = lower_stiffness_of_all(mesh, {1.0, poisson});
  // six springs that hold the rigid motions and, the load being in balance, carry no force
  const int inner = static_cast<int>(testing::ellipsoid(levels, Vector3d::Ones()).positions.size());
  for (const int degree_of_freedom : {0, 1, 2, 3 * 5 + 0, 3 * 5 + 1, 3 * 9 + 2}) {
    stiffness.coeffRef(degree_of_freedom, degree_of_freedom) += 1.0;
  }
  const auto boundary = extract_boundary(mesh);
  VectorXd force = VectorXd::Zero(stiffness.rows());
  for (const auto& t : boundary.surface.triangles) {
    const auto& x = boundary.surface.vertices;
    if (x[t[0]].norm() > 1.5) continue;
    const Vector3d third = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]) / -6.0;
    for (const int v : t) force.segment<3>(Eigen::Index{3} * boundary.volume_vertex[v]) += third;
  }
  const VectorXd displacement = solve_one(stiffness, force);
  double mean = 0.0;
  for (Eigen::Index v = 0; v < inner; ++v) mean += displacement.segment<3>(3 * v).dot(mesh.vertices[v]) / inner;
  return mean;
}

TEST_CASE("Lame's thick sphere: the error at the cavity falls with the square of the element size") {
  // reference: u(a) = 0.8 (nu = 0.3) and 0.842857142857 (nu = 0.45) for a = 1, b = 2, p = E = 1
  const double coarse = lame_inner_displacement(2, 4, 0.3) / 0.8 - 1.0;
  const double fine = lame_inner_displacement(3, 8, 0.3) / 0.8 - 1.0;
  MESSAGE("relative error nu = 0.3: ", coarse, " -> ", fine);
  CHECK(coarse < 0.0);
  CHECK(std::abs(coarse) < 0.12);
  CHECK(std::abs(fine) < 0.032);
  CHECK(coarse / fine > 3.0);
  CHECK(coarse / fine < 5.0);
  const double nearly_incompressible = lame_inner_displacement(3, 8, 0.45) / 0.842857142857 - 1.0;
  MESSAGE("relative error nu = 0.45: ", nearly_incompressible);
  CHECK(std::abs(nearly_incompressible) < 0.069);
  CHECK(nearly_incompressible < fine);
}

/// Work-conjugate tip deflection of the clamped beam 10 x 1 x 1, E = 1000, nu = 0.3, unit uniform tip shear.
double cantilever_deflection(int cells_across) {
  const auto mesh = testing::box({5 * cells_across, cells_across, cells_across}, {10, 1, 1});
  std::vector<std::uint8_t> fixed;
  for (const auto& x : mesh.vertices) fixed.push_back(x.x() == 0.0 ? 1 : 0);
  const FreeVertices free(fixed);
  VectorXd force = VectorXd::Zero(Eigen::Index{3} * free.count);
  for (const auto& t : boundary_triangles(mesh)) {
    const Vector3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    if (std::min({a.x(), b.x(), c.x()}) < 10.0) continue;
    for (const int v : t) force[3 * free.number[v] + 2] += (b - a).cross(c - a).norm() / 6.0;
  }
  CHECK(force.sum() == doctest::Approx(1.0));
  return force.dot(solve_one(assemble_stiffness(mesh, {1000.0, 0.3}, free), force));
}

TEST_CASE("a clamped beam's deflection converges from below to the exact 4.004") {
  const std::array<double, 3> error = {1.0 - cantilever_deflection(2) / 4.004, 1.0 - cantilever_deflection(4) / 4.004,
                                       1.0 - cantilever_deflection(8) / 4.004};
  MESSAGE("relative error with 2, 4, 8 cells across: ", error[0], ", ", error[1], ", ", error[2]);
  CHECK(error[2] > 0.0);
  CHECK(error[1] / error[2] > error[0] / error[1]);
  CHECK(error[1] / error[2] > 2.5);
  // Richardson's extrapolation of the two finest
  const double limit = (4.0 * error[2] - error[1]) / 3.0;
  CHECK(std::abs(limit) < 0.05);
}

TEST_CASE("impossible materials and elements are named") {
  const auto mesh = testing::box({1, 1, 1}, {1, 1, 1});
  const FreeVertices free(std::vector<std::uint8_t>(8, 0));
  CHECK_THROWS_WITH((void)assemble_stiffness(mesh, {0.0, 0.3}, free), doctest::Contains("Young"));
  CHECK_THROWS_WITH((void)assemble_stiffness(mesh, {1.0, 0.5}, free), doctest::Contains("Poisson"));
  auto inverted = mesh;
  std::swap(inverted.tetrahedra[2][0], inverted.tetrahedra[2][1]);
  CHECK_THROWS_WITH((void)assemble_stiffness(inverted, {1.0, 0.3}, free), doctest::Contains("tetrahedron 2"));
}

}  // namespace
}  // namespace greenloop::offline
