#include "offline/simulate/multigrid_model.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "offline/simulate/solid_dynamics.hpp"
#include "offline/simulate/testing/simulated_body.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "runtime/multigrid/elements.hpp"

namespace greenloop::offline {
namespace {

/// A beam of rubber held at its left end, 2 x 1 x 1 cells of 5 cm each `cells` split.
MultigridScene beam(int cells) {
  MultigridScene scene;
  scene.mesh = testing::box({4 * cells, cells, cells}, {0.2, 0.05, 0.05});
  scene.coarser = {testing::box({2 * cells, cells / 2, cells / 2}, {0.2, 0.05, 0.05})};
  for (const Eigen::Vector3d& v : scene.mesh.vertices) scene.fixed.push_back(v.x() < 1.0e-9 ? 1 : 0);
  scene.matter.kinds = {{{2.0e5, 0.3}, 1000.0}};
  scene.matter.kind.assign(scene.mesh.tetrahedra.size(), 0);
  scene.time_step = 1.0e-3;
  return scene;
}

Eigen::VectorXd free_displacements(const SimulatedBody& body) {
  Eigen::VectorXd u(3 * body.view().info->free);
  for (Eigen::Index v = 0; 3 * v < u.size(); ++v) {
    const Vec3& d = body.displacement()[v];
    u.segment<3>(3 * v) = Eigen::Vector3d(d.x, d.y, d.z);
  }
  return u;
}

/// Newmark's method in double precision, each step solved to round-off with the factor of the body at rest.
class Reference {
 public:
  Reference(const MultigridScene& scene, bool corotational)
      : scene_(scene),
        corotational_(corotational),
        free_(scene.fixed),
        elements_(scene.mesh, scene.matter.kinds[0].material, free_),
        mass_(assemble_mass(scene.mesh, scene.matter.kinds[0].density, free_)),
        weight_(vertex_masses(scene.mesh, scene.matter.kinds[0].density, free_)),
        u(Eigen::VectorXd::Zero(3 * free_.count)),
        v(u),
        a(u) {
    Eigen::SparseMatrix<double> mass3(3 * free_.count, 3 * free_.count);
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < mass_.outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(mass_, column); it; ++it) {
        for (int i = 0; i < 3; ++i) {
          entries.emplace_back(3 * static_cast<int>(it.row()) + i, 3 * column + i, it.value());
        }
      }
    }
    mass3.setFromTriplets(entries.begin(), entries.end());
    mass_ = mass3;
    const double dt = scene.time_step;
    const Eigen::SparseMatrix<double> k = assemble_stiffness(scene.mesh, scene.matter.kinds[0].material, free_);
    factor_ = std::make_unique<Factorization>((1 + 2 * scene.stiffness_damping / dt) * k + 4 / (dt * dt) * mass_, 3);
  }

  void step() {
    const double dt = scene_.time_step;
    const Eigen::VectorXd u_star = u + dt * v + 0.25 * dt * dt * a, v_star = v + 0.5 * dt * a;
    a.setZero();
    for (int i = 0; i < 100; ++i) {
      u = u_star + 0.25 * dt * dt * a;
      v = v_star + 0.5 * dt * a;
      const auto r = corotational_ ? elements_.rotations(u) : elements_.no_rotations();
      Eigen::MatrixXd rest = -elements_.elastic_force(u, r) -
                             scene_.stiffness_damping * elements_.stiffness_times(r, v) -
                             mass_.selfadjointView<Eigen::Lower>() * a;
      for (int k = 0; k < free_.count; ++k) rest.block<3, 1>(3 * k, 0) += weight_[k] * scene_.gravity;
      if (rest.norm() < 1.0e-10) break;
      factor_->solve(rest);
      a += 4 / (dt * dt) * rest;
    }
  }

 private:
  const MultigridScene& scene_;
  bool corotational_;
  FreeVertices free_;
  SolidElements elements_;
  Eigen::SparseMatrix<double> mass_;
  Eigen::VectorXd weight_;
  std::unique_ptr<Factorization> factor_;

 public:
  Eigen::VectorXd u, v, a;
};

/// Falls from rest under gravity; the largest difference from the reference, of its largest displacement.
double difference_from_reference(layout::Strain strain, int steps) {
  MultigridScene scene = beam(4);
  scene.strain = strain;
  scene.stiffness_damping = 1.0e-3;
  SimulatedBody body(scene);
  Reference reference(scene, strain == layout::Strain::corotational);
  double largest = 0, size = 0;
  for (int i = 0; i < steps; ++i) {
    REQUIRE(answered(body.step({}).status));
    reference.step();
    largest = std::max(largest, (free_displacements(body) - reference.u).norm());
    size = std::max(size, reference.u.norm());
  }
  return largest / size;
}

}  // namespace

TEST_CASE("a body that is loaded without inertia comes to the static displacement in a step") {
  MultigridScene scene = beam(4);
  scene.strain = layout::Strain::linear;
  scene.time_step = 1.0e3;
  SimulatedBody body(scene);
  const auto report = body.step({});
  CHECK(report.status == Status::ok);
  CHECK(report.residual <= 1.0e-4F);
  const FreeVertices free(scene.fixed);
  Factorization factor(assemble_stiffness(scene.mesh, scene.matter.kinds[0].material, free), 3);
  const Eigen::VectorXd masses = vertex_masses(scene.mesh, 1000.0, free);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(3 * free.count, 1);
  for (int v = 0; v < free.count; ++v) u(3 * v + 2, 0) = -9.81 * masses[v];
  factor.solve(u);
  CHECK((free_displacements(body) - u).norm() <= 1.0e-3 * u.norm());
}

TEST_CASE("a beam falls as a reference in double precision does") {
  CHECK(difference_from_reference(layout::Strain::linear, 100) < 1.0e-3);
  CHECK(difference_from_reference(layout::Strain::corotational, 100) < 1.0e-3);
}

TEST_CASE("linear motion without damping keeps its energy") {
  MultigridScene scene = beam(2);
  scene.coarser.clear();
  scene.strain = layout::Strain::linear;
  SimulatedBody body(scene, {.tolerance = 1.0e-6F});
  for (int i = 0; i < 20; ++i) body.step({});
  const Vec3 weightless{};
  const auto energy = [&] {
    const Multigrid::Energy now = body.body().energy();
    return static_cast<double>(now.kinetic) + static_cast<double>(now.elastic);
  };
  body.step({.gravity = &weightless});  // of which half goes by the weight of the step before
  const double before = energy();
  double least = before, most = before;
  for (int i = 0; i < 500; ++i) {
    body.step({.gravity = &weightless});
    least = std::min(least, energy());
    most = std::max(most, energy());
  }
  CHECK(before > 0);
  CHECK(least > 0.99 * before);
  CHECK(most < 1.01 * before);
}

TEST_CASE("an element that turns feels nothing, through full turns") {
  TetrahedronGroup group{};
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    for (std::uint32_t corner = 0; corner < 4; ++corner) group.vertex[corner][lane] = corner;
  }
  for (int a = 0; a < 3; ++a) group.gradient[a][a] = greenloop::splat(1.0F);
  group.lambda = greenloop::splat(1.0F);
  group.mu = greenloop::splat(1.0F);
  Quaternion4 quaternion{Float4{}, Float4{}, Float4{}, greenloop::splat(1.0F)};
  Matrix4 frame{};
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -3).normalized();
  float worst = 0;
  for (int i = 1; i <= 200; ++i) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(i * 0.02 * std::acos(-1.0), axis).toRotationMatrix();
    std::vector<Float4> displacement(4), force(4), none(4);
    for (int corner = 1; corner < 4; ++corner) {
      const Eigen::Vector3d moved = turn.col(corner - 1) - Eigen::Vector3d::Unit(corner - 1);
      displacement[corner] =
          Float4{static_cast<float>(moved.x()), static_cast<float>(moved.y()), static_cast<float>(moved.z()), 0};
    }
    find_frames(StrainMeasure::corotational, {&group, 1}, displacement.data(), {&quaternion, 1}, {&frame, 1});
    subtract_forces(StrainMeasure::corotational, {&group, 1}, {&frame, 1}, displacement.data(), none.data(), 0,
                    none.data(), force.data());
    for (const Float4& f : force) worst = std::max({worst, std::abs(f[0]), std::abs(f[1]), std::abs(f[2])});
  }
  CHECK(worst < 1.0e-5F);  // of moduli of 1 in four elements
}

TEST_CASE("short of budget a step answers with what it has, never beyond it, and refuses less than the least") {
  MultigridScene scene = beam(4);
  scene.numerical_damping = 0.1;
  SimulatedBody body(scene);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> number(-1, 1);
  const std::uint32_t free = body.view().info->free;
  CHECK(answered(body.step({}, body.need().least_work).status));
  CHECK(body.step({}, body.need().least_work / 2).status == Status::held_over_budget);
  std::size_t coarser = 0;
  std::vector<Multigrid::Load> loads;
  Vec3 from{};
  for (int i = 0; i < 3000; ++i) {
    if (i % 100 == 0) {
      loads.clear();
      for (int k = 0; k < 3; ++k) {
        loads.push_back(
            {static_cast<std::uint32_t>(random() % free), {number(random), number(random), number(random)}});
      }
    }
    std::vector<Multigrid::Hold> holds;
    if (i % 200 < 100) {
      const std::uint32_t v = (i / 200 * 37U) % free;
      if (i % 200 == 0) from = body.displacement()[v];
      const float t = 0.0002F * static_cast<float>(i % 200);
      holds.push_back({v, {from.x + t, from.y, from.z - t}});
    }
    const std::uint64_t work = body.need().least_work + random() % 3 * body.need().cycle_work;
    const auto report = body.step({.loads = loads, .holds = holds}, work);
    REQUIRE(answered(report.status));
    REQUIRE(report.work <= work);
    coarser += report.status == Status::coarser ? 1 : 0;
  }
  CHECK(coarser > 0);
  float farthest = 0;
  for (const Vec3& d : body.displacement()) farthest = std::max(farthest, std::hypot(d.x, d.y, d.z));
  CHECK(farthest < 0.3F);
}

}  // namespace greenloop::offline
