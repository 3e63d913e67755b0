#include "runtime/friction/contact_problem.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "runtime/testing/half_space.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d vector(const Vec4& v) { return {v.x, v.y, v.z}; }
Vec4 stored(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

// sums over contacts, in double precision
void check_cones(const ContactBench& bench) {
  for (std::size_t i = 0; i < bench.force.size(); ++i) {
    const Vector3d n = vector(bench.candidates[i].normal);
    const Vector3d f = vector(bench.force[i]);
    const double normal = f.dot(n);
    CHECK(normal >= 0);
    const double friction = (f - normal * n).norm();
    CHECK(friction <= bench.candidates[i].friction * normal + (bench.candidates[i].friction > 0 ? 0 : 2e-7 * normal));
    CHECK((bench.state[i] == ContactState::open) == (normal == 0));
  }
}

struct Sphere {
  double radius, depth;
  Vector2d at = Vector2d::Zero();
};

std::vector<double> gaps(const HalfSpacePatch& patch, const Sphere& sphere) {
  std::vector<double> gap;
  for (std::uint32_t i = 0; i < patch.count(); ++i) {
    gap.push_back((patch.place(i) - sphere.at).squaredNorm() / (2 * sphere.radius) - sphere.depth);
  }
  return gap;
}

// a sphere whose contact has a radius of 0.9 mm on a patch of 2 mm
constexpr double patch_edge = 2e-3;
constexpr double contact_radius = 0.9e-3;
constexpr double sphere_radius = 20e-3;

HalfSpacePatch patch_of(std::uint32_t across, double poisson = 0.5) {
  return {across, patch_edge / across, 1e5, poisson};
}

double hertz(const HalfSpacePatch& patch, double depth) {
  return 4.0 / 3 * patch.plane_modulus() * std::sqrt(sphere_radius * depth) * depth;
}

TEST_CASE("a sphere without friction needs Hertz's force, the more exactly the finer the cells are") {
  std::vector<double> worst;
  for (const std::uint32_t across : {8U, 16U}) {
    const HalfSpacePatch patch = patch_of(across);
    ContactBench bench(patch);
    MovingTool tool(bench);
    worst.push_back(0);
    for (int k = 11; k <= 20; ++k) {
      const double a = contact_radius * k / 20;
      const double depth = a * a / sphere_radius;
      const ContactAnswer answer = tool.step(gaps(patch, {sphere_radius, depth}), Vector3d::Zero());
      CHECK(answer.valid);
      CHECK(answer.residual <= 1e-3F);
      const double error = std::abs(bench.total().z() / hertz(patch, depth) - 1);
      worst.back() = std::max(worst.back(), error);
      check_cones(bench);
    }
    MESSAGE("worst error of Hertz's force with " << across << " cells across: " << worst.back());
  }
  CHECK(worst[0] <= 0.03);
  CHECK(worst[1] <= 0.01);
  CHECK(worst[1] <= worst[0] / 2);
}

TEST_CASE("a square punch has King's stiffness, to first order in the cells") {
  std::vector<double> error;
  for (const std::uint32_t across : {4U, 8U, 16U}) {
    const HalfSpacePatch patch = patch_of(across);
    ContactBench bench(patch);
    MovingTool tool(bench);
    const double depth = 1e-5;
    CHECK(tool.step(std::vector<double>(patch.count(), -depth), Vector3d::Zero()).residual <= 1e-3F);
    const double exact = 1.0124 * 2 * patch.plane_modulus() * depth * patch_edge / std::sqrt(std::numbers::pi);
    error.push_back(bench.total().z() / exact - 1);
    MESSAGE("error of the punch with " << across << " cells across: " << error.back());
  }
  CHECK(std::abs(error[2]) <= 0.03);
  CHECK(std::abs(2 * error[2] - error[1]) <= 0.01);
  CHECK(error[1] / error[0] <= 0.6);
  CHECK(error[2] / error[1] <= 0.6);
}

// a sphere pressed, then dragged along x; poisson 0.5: normal and tangential problems do not meet
TEST_CASE("a sphere that is pressed and dragged sticks and slips as Cattaneo and Mindlin found") {
  const HalfSpacePatch patch = patch_of(16);
  constexpr double mu = 0.4;
  ContactBench bench(patch);
  for (ContactCandidate& candidate : bench.candidates) candidate.friction = mu;
  MovingTool tool(bench);
  const double a = contact_radius;
  const double depth = a * a / sphere_radius;
  const std::vector<double> gap = gaps(patch, {sphere_radius, depth});
  tool.step(gap, Vector3d::Zero());
  const double pressed = bench.total().z();
  // the way at which all slips
  const double whole = 3 * mu * hertz(patch, depth) * (2 - patch.poisson) / (16 * patch.shear * a);
  constexpr int steps = 20;
  for (int k = 1; k <= steps; ++k) {
    const double way = whole * k / steps;
    const ContactAnswer answer = tool.step(gap, Vector3d(whole / steps, 0, 0));
    CHECK(answer.residual <= 1e-3F);
    check_cones(bench);
    const double exact = mu * hertz(patch, depth) * (1 - std::pow(1 - way / whole, 1.5));
    CAPTURE(k);
    CHECK(std::abs(bench.total().x() - exact) <= 0.05 * exact);
    CHECK(bench.total().z() == doctest::Approx(pressed).epsilon(2e-3));
    // the area that sticks
    double cells = 0;
    for (const ContactState state : bench.state) cells += state == ContactState::stick ? 1 : 0;
    const double radius = std::sqrt(cells * patch.cell * patch.cell / std::numbers::pi);
    const double sticking = a * std::sqrt(1 - way / whole);
    CHECK(std::abs(radius - sticking) <= patch.cell);
  }
}

// symmetric and positive definite, a mixture of what each contact does alone and of what moves all
struct RandomProblem {
  RandomProblem(unsigned seed, std::uint32_t count, double common, double friction) : random(seed), bench(count) {
    const auto order = Index{3} * count;
    MatrixXd root(order, order);
    for (double& x : root.reshaped()) x = normal(random);
    MatrixXd all = root * root.transpose() / static_cast<double>(order) + 0.3 * MatrixXd::Identity(order, order);
    MatrixXd rigid(order, 3);
    for (double& x : rigid.reshaped()) x = normal(random);
    all += common * rigid * rigid.transpose();
    for (std::uint32_t j = 0; j < count; ++j) {
      for (std::uint32_t i = 0; i <= j; ++i) bench.set_block(i, j, all.block<3, 3>(Index{3} * i, Index{3} * j));
      bench.candidates[j].normal = stored(direction());
      bench.candidates[j].gap = stored(direction());
      bench.candidates[j].friction = static_cast<float>(friction);
    }
  }
  Vector3d direction() { return Vector3d(normal(random), normal(random), normal(random)).normalized(); }

  std::mt19937 random;
  std::normal_distribution<double> normal;
  ContactBench bench;
};

Vector3d projected(const Vector3d& f, const Vector3d& n, double mu) {
  const double normal = f.dot(n);
  const Vector3d tangent = f - normal * n;
  const double friction = tangent.norm();
  if (normal >= 0 && friction <= mu * normal) return f;
  if (mu * friction <= -normal) return Vector3d::Zero();
  const double nearest = (normal + mu * friction) / (1 + mu * mu);
  return nearest * (n + mu / friction * tangent);
}

// forces by Uzawa's iteration on the bipotential (De Saxce & Feng 1998), slow and independent of the solver
VectorXd reference(const ContactBench& bench) {
  const MatrixXd a = bench.compliance();
  const double step = 0.5 / Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues().maxCoeff();
  VectorXd gap(a.rows());
  for (std::size_t i = 0; i < bench.candidates.size(); ++i) gap.segment<3>(3 * i) = vector(bench.candidates[i].gap);
  VectorXd f = VectorXd::Zero(a.rows());
  for (int k = 0; k < 200000; ++k) {
    const VectorXd u = gap + a * f;
    const VectorXd last = f;
    for (std::size_t i = 0; i < bench.candidates.size(); ++i) {
      const Vector3d n = vector(bench.candidates[i].normal).normalized();
      const double mu = bench.candidates[i].friction;
      const Vector3d ui = u.segment<3>(3 * i);
      const double slip = (ui - ui.dot(n) * n).norm();
      f.segment<3>(3 * i) = projected(Vector3d(last.segment<3>(3 * i) - step * (ui + mu * slip * n)), n, mu);
    }
    if ((f - last).norm() <= 1e-12 * f.norm()) return f;
  }
  return VectorXd::Constant(a.rows(), NAN);
}

VectorXd forces(const ContactBench& bench) {
  VectorXd f(3 * bench.force.size());
  for (std::size_t i = 0; i < bench.force.size(); ++i) f.segment<3>(3 * i) = vector(bench.force[i]);
  return f;
}

TEST_CASE("random problems have the solution of an independent solver in double precision") {
  for (const double friction : {0.0, 0.2, 0.5}) {
    for (const double common : {0.0, 1.0}) {
      for (unsigned seed = 1; seed <= 20; ++seed) {
        RandomProblem problem(seed, 12, common, friction);
        ContactBench& bench = problem.bench;
        CAPTURE(friction);
        CAPTURE(common);
        CAPTURE(seed);
        const ContactAnswer answer = bench.solve({.residual = 1e-5F});
        CHECK(answer.valid);
        CHECK(answer.residual <= 1e-5F);
        check_cones(bench);
        const VectorXd exact = reference(bench);
        CHECK((forces(bench) - exact).norm() <= 2e-4 * exact.norm());
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
