#include "offline/simulate/solid_dynamics.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("simulation: ") + what);
}

const SolidProblem& checked(const SolidProblem& problem) {
  require(problem.fixed.size() == problem.mesh.vertices.size(), "one mark of what is fixed for each vertex is needed");
  require(problem.density > 0 && std::isfinite(problem.density), "the density must be positive");
  require(problem.time_step > 0 && std::isfinite(problem.time_step), "the time step must be positive");
  require(problem.mass_damping >= 0 && problem.stiffness_damping >= 0, "damping must not be negative");
  require(problem.newmark.gamma >= 0.5 && 2 * problem.newmark.beta >= problem.newmark.gamma,
          "Newmark's method is stable for 2 beta >= gamma >= 1/2");
  return problem;
}

/// Vectors of three numbers a vertex, as a row for each vertex.
auto by_vertex(const Eigen::VectorXd& x) {
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(x.data(), x.size() / 3, 3);
}

Eigen::VectorXd flat(const Eigen::MatrixXd& rows) {
  Eigen::VectorXd x(rows.size());
  for (Eigen::Index v = 0; v < rows.rows(); ++v) x.segment<3>(3 * v) = rows.row(v).transpose();
  return x;
}

/// The same matrix for each of three axes.
Eigen::SparseMatrix<double> for_each_axis(const Eigen::SparseMatrix<double>& lower) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(3 * lower.nonZeros());
  for (int c = 0; c < lower.outerSize(); ++c) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, c); it; ++it) {
      for (int i = 0; i < 3; ++i) entries.emplace_back(3 * static_cast<int>(it.row()) + i, 3 * c + i, it.value());
    }
  }
  Eigen::SparseMatrix<double> result(3 * lower.rows(), 3 * lower.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

SolidDynamics::SolidDynamics(const SolidProblem& problem)
    : problem_(checked(problem)),
      free_(problem.fixed),
      elements_(problem.mesh, problem.material, free_),
      mass_(assemble_mass(problem.mesh, problem.density, free_)),
      stiffness_(assemble_stiffness(problem.mesh, problem.material, free_)),
      mass_share_(1 + problem.newmark.gamma * problem.time_step * problem.mass_damping),
      stiffness_share_(problem.newmark.beta * problem.time_step * problem.time_step +
                       problem.newmark.gamma * problem.time_step * problem.stiffness_damping),
      effective_(mass_share_ * for_each_axis(mass_) + stiffness_share_ * stiffness_, 3),
      mass_factor_(mass_) {}

SolidDynamics::State SolidDynamics::rest() const {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(Eigen::Index{3} * free_.count);
  return {zero, zero, zero};
}

SolidElements::Rotations SolidDynamics::rotations(const Eigen::VectorXd& u) const {
  return problem_.strain == Strain::linear ? elements_.no_rotations() : elements_.rotations(u);
}

Eigen::VectorXd SolidDynamics::mass_times(const Eigen::VectorXd& x) const {
  return flat(mass_.selfadjointView<Eigen::Lower>() * by_vertex(x));
}

Eigen::VectorXd SolidDynamics::solve_mass(const Eigen::VectorXd& side) {
  Eigen::MatrixXd rows = by_vertex(side);
  mass_factor_.solve(rows);
  return flat(rows);
}

Eigen::VectorXd SolidDynamics::velocity_jump(const Eigen::Vector3d& support) {
  const Eigen::VectorXd masses = vertex_masses(problem_.mesh, problem_.density, free_);
  return solve_mass(flat(-masses * support.transpose()));
}

void SolidDynamics::balance(State& state) {
  const auto r = rotations(state.u);
  const Eigen::VectorXd force = elements_.elastic_force(state.u, r) + problem_.mass_damping * mass_times(state.v) +
                                problem_.stiffness_damping * elements_.stiffness_times(r, state.v);
  state.a = -solve_mass(force);
}

SolidDynamics::State SolidDynamics::advanced(const State& from, const Eigen::VectorXd& a) const {
  const double dt = problem_.time_step;
  const auto& [beta, gamma] = problem_.newmark;
  return {from.u + dt * from.v + dt * dt * ((0.5 - beta) * from.a + beta * a),
          from.v + dt * ((1 - gamma) * from.a + gamma * a), a};
}

Eigen::VectorXd SolidDynamics::residual(const State& state, const SolidElements::Rotations& r, double& size) const {
  const Eigen::VectorXd inertia = mass_times(state.a), elastic = elements_.elastic_force(state.u, r);
  size = inertia.norm() + elastic.norm();
  return inertia + elastic + problem_.mass_damping * mass_times(state.v) +
         problem_.stiffness_damping * elements_.stiffness_times(r, state.v);
}

Eigen::VectorXd SolidDynamics::tangent_times(const SolidElements::Rotations& r, const Eigen::VectorXd& x) const {
  return mass_share_ * mass_times(x) + stiffness_share_ * elements_.stiffness_times(r, x);
}

Eigen::VectorXd SolidDynamics::precondition(const SolidElements::Rotations& vertices, const Eigen::VectorXd& x) {
  Eigen::MatrixXd turned(x.size(), 1);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto at = static_cast<Eigen::Index>(3 * v);
    turned.col(0).segment<3>(at) = vertices[v].transpose() * x.segment<3>(at);
  }
  effective_.solve(turned);
  Eigen::VectorXd result(x.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto at = static_cast<Eigen::Index>(3 * v);
    result.segment<3>(at) = vertices[v] * turned.col(0).segment<3>(at);
  }
  return result;
}

/// Conjugate gradients: Newton's method needs no more than a digit of each correction.
Eigen::VectorXd SolidDynamics::solve(const SolidElements::Rotations& r, const Eigen::VectorXd& side) {
  constexpr double tolerance = 1e-1;
  constexpr int most_iterations = 50;
  const auto vertices = elements_.vertex_rotations(r);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(side.size()), rest = side, z = precondition(vertices, rest), p = z;
  double rz = rest.dot(z);
  const double goal = tolerance * tolerance * rz;
  for (int i = 0; i < most_iterations && rz > goal; ++i) {
    const Eigen::VectorXd kp = tangent_times(r, p);
    const double along = rz / p.dot(kp);
    x += along * p;
    rest -= along * kp;
    z = precondition(vertices, rest);
    const double next = rest.dot(z);
    p = z + next / rz * p;
    rz = next;
  }
  return x;
}

void SolidDynamics::step(State& state) {
  constexpr double tolerance = 1e-5;
  constexpr int most_iterations = 100;
  State next = advanced(state, state.a);
  double size = 0;
  if (problem_.strain == Strain::linear) {
    const auto none = elements_.no_rotations();
    Eigen::MatrixXd correction = residual(next, none, size);
    effective_.solve(correction);
    state = advanced(state, next.a - correction.col(0));
    return;
  }
  for (int i = 0; i < most_iterations; ++i) {
    const auto r = elements_.rotations(next.u);
    const Eigen::VectorXd lacks = residual(next, r, size);
    if (!std::isfinite(size)) break;
    if (lacks.norm() <= tolerance * size) {
      state = std::move(next);
      return;
    }
    next = advanced(state, next.a - solve(r, lacks));
  }
  throw std::runtime_error("simulation: a step of " + std::to_string(problem_.time_step) +
                           " s found no balance; make the time step shorter, or the impulses weaker");
}

double SolidDynamics::energy(const State& state) const {
  return 0.5 * state.v.dot(mass_times(state.v)) + elements_.energy(state.u, rotations(state.u));
}

double SolidDynamics::lowest_frequency() const {
  constexpr int iterations = 30;
  Factorization factor(stiffness_, 3);
  Eigen::VectorXd x = mass_times(Eigen::VectorXd::Ones(Eigen::Index{3} * free_.count));
  double squared = 0;
  for (int i = 0; i < iterations; ++i) {
    Eigen::MatrixXd y = x;
    factor.solve(y);
    const Eigen::VectorXd my = mass_times(y.col(0));
    squared = y.col(0).dot(x) / y.col(0).dot(my);
    x = my / std::sqrt(y.col(0).dot(my));
  }
  return std::sqrt(squared);
}

}  // namespace greenloop::offline
