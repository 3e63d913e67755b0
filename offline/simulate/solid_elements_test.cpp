#include "offline/simulate/solid_elements.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Material rubber{1e5, 0.4};

struct FreeBox {
  TetrahedralMesh mesh = testing::box({4, 3, 2}, {0.4, 0.3, 0.2});
  FreeVertices free{std::vector<std::uint8_t>(mesh.vertices.size(), 0)};
  SolidElements elements{mesh, rubber, free};

  template <class Field>
  [[nodiscard]] VectorXd sample(const Field& field) const {
    VectorXd values(3 * free.count);
    for (int v = 0; v < free.count; ++v) values.segment<3>(3 * v) = field(mesh.vertices[v]);
    return values;
  }
};

const Matrix3d turn = Eigen::AngleAxisd(2, Vector3d(1, 2, -1).normalized()).toRotationMatrix();

Vector3d wave(const Vector3d& x) { return 0.02 * Vector3d(std::sin(9 * x.y()), std::cos(7 * x.z()), x.x() * x.y()); }

TEST_CASE("the rotation of a deformation is orthogonal and leaves a symmetric stretch") {
  Matrix3d stretch;
  stretch << 1.4, 0.2, 0.1, 0.2, 0.7, -0.1, 0.1, -0.1, 1.1;
  CHECK((rotation_of(turn * stretch) - turn).norm() < 1e-13);
  // inside out: still a rotation
  const Matrix3d inverted = Matrix3d(Vector3d(1, 1, -0.5).asDiagonal());
  CHECK(rotation_of(inverted).determinant() == doctest::Approx(1));
  CHECK((rotation_of(inverted).transpose() * rotation_of(inverted) - Matrix3d::Identity()).norm() < 1e-13);
}

TEST_CASE("a body that is turned as a whole has no ghost forces with corotational strain, and has with linear") {
  const FreeBox box;
  const VectorXd turned = box.sample([](const Vector3d& x) { return Vector3d(turn * x - x); });
  const double linear = box.elements.elastic_force(turned, box.elements.no_rotations()).norm();
  CHECK(linear > 1e3);
  CHECK(box.elements.elastic_force(turned, box.elements.rotations(turned)).norm() < 1e-11 * linear);
}

TEST_CASE("forces turn with the body") {
  const FreeBox box;
  const VectorXd u = box.sample(wave);
  const VectorXd turned = box.sample([](const Vector3d& x) { return Vector3d(turn * (x + wave(x)) - x); });
  const VectorXd force = box.elements.elastic_force(u, box.elements.rotations(u));
  const VectorXd force_of_turned = box.elements.elastic_force(turned, box.elements.rotations(turned));
  for (int v = 0; v < box.free.count; ++v) {
    CHECK((force_of_turned.segment<3>(3 * v) - turn * force.segment<3>(3 * v)).norm() < 1e-11 * force.norm());
  }
}

TEST_CASE("the elastic force is the gradient of the energy") {
  const FreeBox box;
  const VectorXd u = box.sample(wave),
                 way = box.sample([](const Vector3d&x) { return Vector3d(x.z(), x.x(), -x.y()); });
  for (const bool corotational : {false, true}) {
    const auto rotations = [&](const VectorXd& at) {
      return corotational ? box.elements.rotations(at) : box.elements.no_rotations();
    };
    const auto energy = [&](double t) { return box.elements.energy(u + t * way, rotations(u + t * way)); };
    const double slope = (energy(1e-5) - energy(-1e-5)) / 2e-5;
    CHECK(box.elements.elastic_force(u, rotations(u)).dot(way) == doctest::Approx(slope).epsilon(1e-7));
  }
}

TEST_CASE("without rotations the elements have the assembled stiffness") {
  const FreeBox box;
  const VectorXd u = box.sample(wave);
  const VectorXd assembled = assemble_stiffness(box.mesh, rubber, box.free).selfadjointView<Eigen::Lower>() * u;
  const auto none = box.elements.no_rotations();
  CHECK((box.elements.elastic_force(u, none) - assembled).norm() < 1e-12 * assembled.norm());
  CHECK((box.elements.stiffness_times(none, u) - assembled).norm() < 1e-12 * assembled.norm());
}

TEST_CASE("consistent mass: all of it, and that of linear functions") {
  const FreeBox box;
  constexpr double density = 900, volume = 0.4 * 0.3 * 0.2;
  const Eigen::SparseMatrix<double> mass = assemble_mass(box.mesh, density, box.free).selfadjointView<Eigen::Lower>();
  CHECK(mass.sum() == doctest::Approx(density * volume));
  CHECK((vertex_masses(box.mesh, density, box.free) - mass * VectorXd::Ones(box.free.count)).norm() < 1e-12);
  VectorXd x(box.free.count);
  for (int v = 0; v < box.free.count; ++v) x[v] = box.mesh.vertices[v].x();
  CHECK(x.dot(mass * x) == doctest::Approx(density * volume * 0.4 * 0.4 / 3));
}

}  // namespace
}  // namespace greenloop::offline
