#include "offline/simulate/solid_dynamics.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using std::numbers::pi;

/// A beam along x, held at its end x = 0.
struct Beam {
  TetrahedralMesh mesh;
  std::vector<std::uint8_t> fixed;

  Beam(const Eigen::Vector3i& cells, const Vector3d& size) : mesh(testing::box(cells, size)) {
    for (const auto& x : mesh.vertices) fixed.push_back(x.x() < 1e-9 * size.x() ? 1 : 0);
  }
  [[nodiscard]] SolidProblem problem(const Material& material, double time_step) const {
    return {.mesh = mesh, .fixed = fixed, .material = material, .density = 1, .time_step = time_step};
  }
  template <class Field>
  [[nodiscard]] VectorXd sample(const Field& field) const {
    const FreeVertices free(fixed);
    VectorXd values(3 * free.count);
    for (std::size_t v = 0; v < fixed.size(); ++v) {
      if (free.number[v] >= 0) values.segment<3>(3 * free.number[v]) = field(mesh.vertices[v]);
    }
    return values;
  }
};

/// Where the sign of `value` changes, in steps, after the first.
template <class Value>
std::vector<double> zeros(SolidDynamics& dynamics, SolidDynamics::State state, int steps, const Value& value) {
  std::vector<double> found;
  for (int i = 0; i < steps; ++i) {
    const double before = value(state);
    dynamics.step(state);
    const double after = value(state);
    if (before * after < 0) found.push_back(i + before / (before - after));
  }
  return found;
}

// without a Poisson effect a bar is a string of springs: its modes are sines, and Newmark's periods are known
// (reference values, section c)
TEST_CASE("a bar's period, longer by what average acceleration and dissipation add") {
  const Beam bar({24, 1, 1}, {1, 0.05, 0.05});
  const double cells = 24, omega_exact = pi / 2;  // rho = E = 1
  // linear elements with consistent mass: omega^2 = 6/h^2 (1 - cos kh) / (2 + cos kh)
  const double c = std::cos(omega_exact / cells);
  const double omega = cells * std::sqrt(6 * (1 - c) / (2 + c));
  struct Case {
    Newmark newmark;
    double of_period, longer;
  };
  for (const auto& [newmark, of_period, longer] :
       {Case{{}, 0.02, 0.0013146}, Case{{}, 0.1, 0.0320749}, Case{Newmark::dissipating(0.6), 0.1, 0.0329459}}) {
    auto problem = bar.problem({1, 0}, of_period * 2 * pi / omega);
    problem.newmark = newmark;
    SolidDynamics dynamics(problem);
    auto state = dynamics.rest();
    state.u = bar.sample([&](const Vector3d& x) { return Vector3d(std::sin(omega_exact * x.x()), 0, 0); });
    dynamics.balance(state);
    const auto at = zeros(dynamics, state, static_cast<int>(4.4 / of_period), [](const auto& s) { return s.u.sum(); });
    REQUIRE(at.size() >= 8);
    const double period = (at[7] - at[1]) / 3 * of_period;
    // the split into tetrahedra couples a little of y and z; zeros are interpolated linearly
    CHECK(period == doctest::Approx(1 + longer).epsilon(1.5e-3));
  }
}

TEST_CASE("amplitudes decay as Newmark's method and Rayleigh's damping say") {
  const Beam bar({12, 1, 1}, {1, 0.05, 0.05});
  const auto decay_per_period = [&](Newmark newmark, double mass_damping, double stiffness_damping, double of_period) {
    auto problem = bar.problem({1, 0}, of_period * 4);
    problem.newmark = newmark;
    problem.mass_damping = mass_damping;
    problem.stiffness_damping = stiffness_damping;
    SolidDynamics dynamics(problem);
    auto state = dynamics.rest();
    state.u = bar.sample([&](const Vector3d& x) { return Vector3d(std::sin(pi / 2 * x.x()), 0, 0); });
    dynamics.balance(state);
    const double before = dynamics.energy(state);
    const int steps = static_cast<int>(std::lround(2 / of_period));
    for (int i = 0; i < steps; ++i) dynamics.step(state);
    return std::sqrt(std::sqrt(dynamics.energy(state) / before));
  };
  CHECK(decay_per_period({}, 0, 0, 0.02) == doctest::Approx(1).epsilon(1e-6));
  // spectral radius 0.982208338 a step at a tenth of the period
  CHECK(decay_per_period(Newmark::dissipating(0.6), 0, 0, 0.1) ==
        doctest::Approx(std::pow(0.982208338, 10)).epsilon(0.01));
  // ratio alpha / (2 omega) + beta omega / 2
  const double omega = pi / 2, alpha = 0.05, beta = 0.02;
  CHECK(decay_per_period({}, alpha, beta, 0.01) ==
        doctest::Approx(std::exp(-4 * (alpha / 2 + beta * omega * omega / 2))).epsilon(2e-3));
}

TEST_CASE("average acceleration keeps the energy of linear strain; corotational strain keeps it nearly") {
  const Beam beam({10, 2, 2}, {10, 1, 1});
  auto problem = beam.problem({1000, 0.3}, 0.25);
  for (const Strain strain : {Strain::linear, Strain::corotational}) {
    problem.strain = strain;
    SolidDynamics dynamics(problem);
    auto state = dynamics.rest();
    state.v = beam.sample([](const Vector3d& x) { return Vector3d(0, 0.02 * x.x() * x.x(), 0); });
    dynamics.balance(state);
    const double before = dynamics.energy(state);
    double least = before, most = before;
    for (int i = 0; i < 200; ++i) {
      dynamics.step(state);
      least = std::min(least, dynamics.energy(state));
      most = std::max(most, dynamics.energy(state));
    }
    const double allowed = strain == Strain::linear ? 1e-9 : 0.02;
    CHECK(most < (1 + allowed) * before);
    CHECK(least > (1 - allowed) * before);
  }
}

TEST_CASE("the lowest frequency of a cantilever comes down to the beam's as the mesh is refined") {
  const Vector3d size(10, 1, 1);
  constexpr double slender = 0.3209668;  // Euler and Bernoulli; shear takes 1.4 % of it off
  const auto lowest = [&](int across) {
    const Beam beam({10 * across, across, across}, size);
    return SolidDynamics(beam.problem({1000, 0.3}, 0.1)).lowest_frequency();
  };
  const double coarse = lowest(2), fine = lowest(4);
  CHECK(coarse > fine);
  CHECK(fine > 0.98 * slender);
  // errors fall with the square of the edge
  CHECK((4 * fine - coarse) / 3 == doctest::Approx(slender).epsilon(0.03));
}

TEST_CASE("a support's jump gives the body its velocity, all of it far from the support") {
  const Beam beam({10, 2, 2}, {10, 1, 1});
  SolidDynamics dynamics(beam.problem({1000, 0.3}, 0.01));
  const VectorXd jump = dynamics.velocity_jump({0, 0.5, 0});
  CHECK(jump.tail<3>().isApprox(Vector3d(0, -0.5, 0), 1e-4));
  // momentum of the body impulse: M jump = -M v0, the support's columns included
  const auto masses = vertex_masses(beam.mesh, 1, dynamics.free());
  const Eigen::SparseMatrix<double> mass = assemble_mass(beam.mesh, 1, dynamics.free()).selfadjointView<Eigen::Lower>();
  const VectorXd y = Eigen::Map<const VectorXd, 0, Eigen::InnerStride<3>>(jump.data() + 1, masses.size());
  CHECK((mass * y + 0.5 * masses).norm() < 1e-12 * masses.norm());
}

TEST_CASE("corotational strain: small motions are those of linear strain, large ones keep the beam's length") {
  const Beam beam({10, 2, 2}, {10, 1, 1});
  const auto tip_after = [&](Strain strain, double velocity) {
    auto problem = beam.problem({1000, 0.3}, 0.25);
    problem.strain = strain;
    SolidDynamics dynamics(problem);
    auto state = dynamics.rest();
    state.v = beam.sample([&](const Vector3d& x) { return Vector3d(0, velocity * x.x() * x.x(), 0); });
    dynamics.balance(state);
    for (int i = 0; i < 15; ++i) dynamics.step(state);
    return Vector3d(state.u.tail<3>());
  };
  const Vector3d small_linear = tip_after(Strain::linear, 1e-6);
  CHECK((tip_after(Strain::corotational, 1e-6) - small_linear).norm() < 1e-4 * small_linear.norm());
  const auto chord = [](const Vector3d& tip) { return (Vector3d(10, 0, 0) + tip).norm(); };
  const Vector3d linear = tip_after(Strain::linear, 0.06), corotational = tip_after(Strain::corotational, 0.06);
  CHECK(linear.norm() > 6);
  CHECK(chord(linear) > 12);
  CHECK(chord(corotational) < 10.3);
}

}  // namespace
}  // namespace greenloop::offline
