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

#include "runtime/algebra/fnv1a.hpp"
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

// a sphere pressed, then dragged along x; poisson 0.5: normal and tangential problems do not meet
TEST_CASE("a sphere that is pressed and dragged sticks and slips as Cattaneo and Mindlin found") {
  const HalfSpacePatch patch = patch_of(16);
  constexpr float mu = 0.4F;
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

// forces on a cell move all others by this much of what they move itself: a patch on something slender
void add_common_mode(const HalfSpacePatch& patch, double part, ContactBench& bench) {
  const Eigen::Matrix3d own = patch.influence(Vector2d::Zero());
  Eigen::Matrix3d common;
  common << 1, 0, 0.5, 0, 0.5, 0, 0.5, 0, 1;
  for (std::uint32_t j = 0; j < patch.count(); ++j) {
    for (std::uint32_t i = 0; i <= j; ++i) {
      bench.set_block(i, j, patch.influence(patch.place(i) - patch.place(j)) + part * own(2, 2) * common);
    }
  }
}

TEST_CASE("contacts on a body that gives way as a whole converge as fast as on a massive one") {
  const HalfSpacePatch patch = patch_of(8, 0.3);
  for (const double part : {0.0, 1.0, 10.0, 100.0}) {
    for (const float friction : {0.0F, 0.3F, 1.0F}) {
      CAPTURE(part);
      CAPTURE(friction);
      ContactBench bench(patch);
      add_common_mode(patch, part, bench);
      for (ContactCandidate& candidate : bench.candidates) candidate.friction = friction;
      MovingTool tool(bench);
      for (int k = 0; k < 20; ++k) {
        const double depth = (1 + 0.01 * k) * (1 + 20 * part) * 4e-5;
        const ContactAnswer answer = tool.step(gaps(patch, {sphere_radius, depth}), Vector3d(k < 10 ? 0 : 1e-6, 0, 0));
        CHECK(answer.residual <= 1e-3F);
        CHECK(answer.iterations <= 5);
        check_cones(bench);
      }
    }
  }
}

TEST_CASE("of points that move alike the forces add up to that of one") {
  RandomProblem single(5, 10, 0.3, 0.3);
  const MatrixXd a = single.bench.compliance();
  RandomProblem twice(5, 20, 0, 0.3);
  for (std::uint32_t j = 0; j < 20; ++j) {
    for (std::uint32_t i = 0; i <= j; ++i)
      twice.bench.set_block(i, j, a.block<3, 3>(Index{3} * (i / 2), Index{3} * (j / 2)));
    twice.bench.candidates[j] = single.bench.candidates[j / 2];
  }
  REQUIRE(single.bench.solve({.residual = 1e-5F}).residual <= 1e-5F);
  REQUIRE(twice.bench.solve({.residual = 1e-5F}).residual <= 1e-5F);
  const VectorXd one = forces(single.bench);
  const VectorXd two = forces(twice.bench);
  for (Index i = 0; i < 10; ++i) {
    CHECK((two.segment<3>(6 * i) + two.segment<3>(6 * i + 3) - one.segment<3>(3 * i)).norm() <= 1e-3 * one.norm());
  }
}

TEST_CASE("nothing that touches without being pressed has a force, and none pulls") {
  const HalfSpacePatch patch = patch_of(4);
  ContactBench bench(patch);
  for (ContactCandidate& candidate : bench.candidates) candidate.friction = 0.5F;
  MovingTool tool(bench);
  for (const double gap : {0.0, 1e-6}) {
    const ContactAnswer answer = tool.step(std::vector<double>(patch.count(), gap), Vector3d(1e-5, 0, 0));
    CHECK(answer.valid);
    CHECK(answer.residual == 0);
    CHECK(bench.total().norm() == 0);
    for (const ContactState state : bench.state) CHECK(state == ContactState::open);
  }
  // from a force that was there before
  for (Vec4& f : bench.force) f = {0.1F, 0, 0.3F, 0};
  tool.step(std::vector<double>(patch.count(), 1e-9), Vector3d::Zero());
  CHECK(bench.total().norm() == 0);
}

// two fingers hold an object from left and right; it hangs on springs and its own weight would lower it by `sag`
ContactAnswer pinch(double sag, double friction, ContactBench& bench) {
  constexpr double own = 1e-3;   // m/N, of each side
  constexpr double body = 5e-2;  // m/N, of the whole
  for (std::uint32_t j = 0; j < 2; ++j) {
    for (std::uint32_t i = 0; i <= j; ++i) {
      bench.set_block(i, j, (i == j ? own + body : body) * Eigen::Matrix3d::Identity());
    }
    const float side = j == 0 ? 1.0F : -1.0F;
    bench.candidates[j].normal = {side, 0, 0, 0};
    bench.candidates[j].gap = {side * -2e-3F, 0, static_cast<float>(-sag), 0};
    bench.candidates[j].friction = static_cast<float>(friction);
  }
  return bench.solve({.residual = 1e-5F});
}

TEST_CASE("an object between two fingers is held by friction, or slides down") {
  ContactBench bench(2);
  CHECK(pinch(0.05, 0.5, bench).residual <= 1e-5F);
  // 2 N from each side, which move it nowhere together; holding it takes 0.05 / (own + 2 body) N from each
  CHECK(bench.force[0].x == doctest::Approx(2));
  CHECK(bench.force[1].x == doctest::Approx(-2));
  for (int j = 0; j < 2; ++j) {
    CHECK(bench.state[j] == ContactState::stick);
    CHECK(bench.force[j].z == doctest::Approx(0.05 / 0.101));
  }
  CHECK(pinch(0.05, 0.2, bench).residual <= 1e-5F);
  for (int j = 0; j < 2; ++j) {
    CHECK(bench.state[j] == ContactState::slip);
    CHECK(bench.force[j].z == doctest::Approx(0.4).epsilon(1e-4));
    CHECK(bench.displacement[j].z == doctest::Approx(-0.05 + 0.4 * 0.101).epsilon(1e-3));
  }
}

TEST_CASE("friction takes energy away at every contact in every step") {
  const HalfSpacePatch patch = patch_of(10, 0.3);
  ContactBench bench(patch);
  for (ContactCandidate& candidate : bench.candidates) candidate.friction = 0.5F;
  MovingTool tool(bench);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> way(-1, 1);
  Vector3d at = Vector3d::Zero();
  double taken = 0;
  for (int k = 0; k < 300; ++k) {
    const Vector3d next(1e-4 * way(random), 1e-4 * way(random), 3e-5 * (1 + way(random)));
    tool.step(gaps(patch, {sphere_radius, next.z(), Vector2d(next.head<2>())}),
              Vector3d(next.x() - at.x(), next.y() - at.y(), 0));
    at = next;
    for (std::size_t i = 0; i < bench.force.size(); ++i) {
      const double work = vector(bench.force[i]).head<2>().dot(vector(bench.displacement[i]).head<2>());
      taken -= work;
      CHECK(work <= 1e-3 * bench.total().norm() * 1e-6);
    }
  }
  CHECK(taken > 0);
}

TEST_CASE("a sphere that slides over scattered points at one depth is pressed evenly") {
  HalfSpacePatch patch = patch_of(16);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> shift(-0.25, 0.25);
  std::vector<Vector2d> place;
  for (std::uint32_t i = 0; i < patch.count(); ++i) {
    place.push_back(patch.place(i) + patch.cell * Vector2d(shift(random), shift(random)));
  }
  ContactBench bench(patch);
  for (std::uint32_t j = 0; j < patch.count(); ++j) {
    for (std::uint32_t i = 0; i <= j; ++i) bench.set_block(i, j, patch.influence(place[i] - place[j]));
    bench.candidates[j].friction = 0.3F;
  }
  MovingTool tool(bench);
  double last = 0;
  double worst = 0;
  int changes = 0;
  std::vector<ContactState> before(patch.count());
  for (int k = 0; k < 120; ++k) {
    const double step = patch.cell / 40;
    const Vector2d at((k - 60) * step, 0);
    std::vector<double> gap;
    gap.reserve(place.size());
    for (const Vector2d& p : place) gap.push_back((p - at).squaredNorm() / (2 * sphere_radius) - 2e-5);
    CHECK(tool.step(gap, Vector3d(k == 0 ? 0 : step, 0, 0)).residual <= 1e-3F);
    const double force = bench.total().norm();
    if (k > 5) CHECK(std::abs(force - last) <= 0.02 * last);  // once all of it slips
    worst = k > 5 ? std::max(worst, std::abs(force / last - 1)) : 0;
    last = force;
    for (std::size_t i = 0; i < before.size(); ++i) {
      changes += (before[i] == ContactState::open) != (bench.state[i] == ContactState::open) ? 1 : 0;
    }
    before = bench.state;
  }
  CHECK(changes > 100);  // points came and went
  MESSAGE("largest step of the force: " << worst);
}

TEST_CASE("any work allowed gives forces in the cones, costs no more, and gives the same bits again") {
  const HalfSpacePatch patch = patch_of(8, 0.3);
  const std::vector<double> gap = gaps(patch, {sphere_radius, 4e-5});
  float last = 2;
  for (std::uint64_t part = 0; part <= 32; ++part) {
    const std::uint64_t work = ContactProblem::least_work({}, 64) + part * ContactProblem::iteration_work({}, 64) / 16;
    ContactBench first(patch);
    ContactBench second(patch);
    for (ContactBench* bench : {&first, &second}) {
      for (std::size_t i = 0; i < gap.size(); ++i) {
        bench->candidates[i].gap = {1e-5F, 0, static_cast<float>(gap[i]), 0};
        bench->candidates[i].friction = 0.4F;
      }
      const ContactAnswer answer = bench->solve({.residual = 1e-6F}, work);
      CHECK(answer.valid);
      CHECK(answer.work <= work);
      CHECK(answer.residual <= last * 1.0001F);
      if (bench == &second) last = answer.residual;
      check_cones(*bench);
    }
    CHECK(std::memcmp(first.force.data(), second.force.data(), first.force.size() * sizeof(Vec4)) == 0);
  }
  CHECK(last <= 1e-5F);
}

TEST_CASE("forces short of work give no more energy than closing the gaps takes, wherever they began") {
  const HalfSpacePatch patch = patch_of(8, 0.3);
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int k = 0; k < 200; ++k) {
    ContactBench bench(patch);
    for (std::size_t i = 0; i < bench.candidates.size(); ++i) {
      bench.candidates[i].gap = {2e-5F * uniform(random), 2e-5F * uniform(random), 3e-5F * uniform(random), 0};
      bench.candidates[i].friction = k % 2 == 0 ? 0.5F : 0;
      // from a step that went wrong: thousands of times what is right
      bench.force[i] = {uniform(random), uniform(random), k % 3 == 0 ? 0 : 30 * (1 + uniform(random)), 0};
    }
    const ContactAnswer answer = bench.solve({.residual = 1e-6F}, ContactProblem::least_work({}, 64));
    REQUIRE(answer.valid);
    check_cones(bench);
    double given = 0, closed = 0;  // J
    for (std::size_t i = 0; i < bench.force.size(); ++i) {
      const Vector3d f = vector(bench.force[i]), gap = vector(bench.candidates[i].gap);
      given += f.dot(vector(bench.displacement[i]) - gap);
      closed -= f.dot(gap);
    }
    CHECK(given <= closed * (1 + 1e-4) + 1e-12);
  }
}

TEST_CASE("what is not finite, and points without a compliance, are refused") {
  for (int k = 0; k < 5; ++k) {
    RandomProblem problem(3, 6, 0, 0.3);
    ContactBench& bench = problem.bench;
    if (k == 0) bench.candidates[4].gap.y = NAN;
    if (k == 1) bench.candidates[4].friction = -1;
    if (k == 2) bench.candidates[4].normal.x = INFINITY;
    if (k == 3) bench.set_block(4, 4, Eigen::Matrix3d::Zero());
    if (k == 4) bench.force[4].z = NAN;
    const ContactAnswer answer = bench.solve();
    CHECK_FALSE(answer.valid);
    CHECK(forces(bench).norm() == 0);
    for (const ContactState state : bench.state) CHECK(state == ContactState::open);
  }
}

TEST_CASE("forces and displacements have the same bits on every compiler and processor") {
  constexpr std::uint32_t count = 40;
  std::uint32_t state = 1;
  const auto drawn = [&state] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8) / (1 << 23) - 1;
  };
  Fnv1a digest;
  for (int k = 0; k < 40; ++k) {
    ContactBench bench(count);
    std::vector<Vector3d> place(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      for (double& x : place[i]) x = drawn();
      place[i].z() *= 0.1;
      const double gap = 0.05 * (place[i].x() * place[i].x() + place[i].y() * place[i].y()) - 0.04;
      bench.candidates[i] = {
          stored({0.01 * drawn(), 0.01 * drawn(), gap}), {0, 0, 1, 0}, 0.3F * static_cast<float>(k % 4)};
    }
    for (std::uint32_t j = 0; j < count; ++j) {
      for (std::uint32_t i = 0; i <= j; ++i) {
        const Vector3d d = place[i] - place[j];
        const double r = std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z() + 0.01);
        Eigen::Matrix3d block;
        for (int c = 0; c < 3; ++c) {
          for (int q = 0; q < 3; ++q)
            block(q, c) = (q == c ? 1 / r : 0) + 0.5 * d[q] * d[c] / (r * r * r) + (q == c ? k % 3 : 0);
        }
        bench.set_block(i, j, block);
      }
    }
    for (int step = 0; step < 3; ++step) {
      for (ContactCandidate& candidate : bench.candidates) candidate.gap.x += 0.001F;
      const ContactAnswer answer = bench.solve({.residual = 1e-4F, .iterations = 20});
      digest.add_words({&answer.residual, 1});
      digest.add_word(answer.work);
      digest.add_words(as_floats(std::span(bench.force)));
      digest.add_words(as_floats(std::span(bench.displacement)));
    }
  }
  CHECK(digest.value() == 9811307219884749668U);
}

}  // namespace
}  // namespace greenloop
