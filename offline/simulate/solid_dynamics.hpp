#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "offline/simulate/solid_elements.hpp"
#include "offline/sources/fem/factorization.hpp"

namespace greenloop::offline {

/// Newmark's method (1959): u' = u + dt v + dt^2 ((1/2 - beta) a + beta a'), v' = v + dt ((1 - gamma) a + gamma a').
struct Newmark {
  double beta = 0.25;  ///< average acceleration: no amplitude decays, periods grow by (omega dt)^2 / 12
  double gamma = 0.5;

  /// What is faster than the time step can follow dies out: gamma above 1/2, beta = (gamma + 1/2)^2 / 4.
  [[nodiscard]] static Newmark dissipating(double gamma) { return {(gamma + 0.5) * (gamma + 0.5) / 4, gamma}; }
};

enum class Strain : std::uint8_t {
  linear,        ///< small rotations only; one back-substitution a step
  corotational,  ///< large rotations, moderate strain
};

/// An elastic solid that hangs on a support.
struct SolidProblem {
  const TetrahedralMesh& mesh;             ///< m
  const std::vector<std::uint8_t>& fixed;  ///< per vertex, nonzero = held by the support
  Material material;
  double density = 0;            ///< kg/m^3
  double mass_damping = 0;       ///< Rayleigh's alpha of C = alpha M + beta K, 1/s
  double stiffness_damping = 0;  ///< and beta, s
  double time_step = 0;          ///< s
  Strain strain = Strain::linear;
  Newmark newmark;
};

/// M u'' + C u' + f(u) = 0 for the displacement u of the free vertices, seen from the support, by Newmark's method,
/// with consistent mass and Rayleigh damping (theory.md, section 7). With corotational strain K of the damping turns
/// with the elements, and the equations of a step are solved by Newton's method with rotations held, each correction by
/// conjugate gradients preconditioned by the factor of the body at rest, turned vertex by vertex. No state but u, v, a:
/// the same state goes on with the same bits. Refers to the problem's mesh.
class SolidDynamics {
 public:
  /// Displacement [m], velocity [m/s], acceleration [m/s^2] of the free vertices, three numbers each.
  struct State {
    Eigen::VectorXd u, v, a;
  };

  /// One factorisation of M + gamma dt C + beta dt^2 K, one of M. Throws std::invalid_argument for values out of range,
  /// std::runtime_error if the body is not supported or memory runs out.
  explicit SolidDynamics(const SolidProblem& problem);

  [[nodiscard]] const FreeVertices& free() const { return free_; }
  [[nodiscard]] State rest() const;
  /// What a jump of the support's velocity [m/s] does to the velocities, seen from it: M^-1 of the body impulse -M v0
  /// (James & Fatahalian 2003, section 3.4). Work: a back-substitution.
  [[nodiscard]] Eigen::VectorXd velocity_jump(const Eigen::Vector3d& support);
  /// The acceleration that belongs to displacement and velocity. Work: a back-substitution.
  void balance(State& state);
  /// Throws std::runtime_error if Newton's method does not settle; the state is as before then. Work: a
  /// back-substitution with linear strain; with corotational strain some ten, and as many sweeps over the elements.
  void step(State& state);

  /// Kinetic and elastic, J.
  [[nodiscard]] double energy(const State& state) const;
  /// Angular frequency of the slowest vibration about rest, 1/s, by inverse iteration; to 1 % or better, from above.
  /// Work: a factorisation and 30 back-substitutions.
  [[nodiscard]] double lowest_frequency() const;

 private:
  [[nodiscard]] SolidElements::Rotations rotations(const Eigen::VectorXd& u) const;
  [[nodiscard]] Eigen::VectorXd mass_times(const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd tangent_times(const SolidElements::Rotations& r, const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd residual(const State& state, const SolidElements::Rotations& r, double& size) const;
  [[nodiscard]] State advanced(const State& from, const Eigen::VectorXd& a) const;
  [[nodiscard]] Eigen::VectorXd precondition(const SolidElements::Rotations& vertices, const Eigen::VectorXd& x);
  [[nodiscard]] Eigen::VectorXd solve(const SolidElements::Rotations& r, const Eigen::VectorXd& side);
  [[nodiscard]] Eigen::VectorXd solve_mass(const Eigen::VectorXd& side);

  SolidProblem problem_;
  FreeVertices free_;
  SolidElements elements_;
  Eigen::SparseMatrix<double> mass_, stiffness_;  // lower triangles; a row of the mass for each vertex
  double mass_share_, stiffness_share_;           // of M and K in M + gamma dt C + beta dt^2 K
  Factorization effective_, mass_factor_;
};

}  // namespace greenloop::offline
