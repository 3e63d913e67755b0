#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/layout.hpp"
#include "formats/trajectory/trajectory_file.hpp"
#include "offline/reduce/reduced_frames.hpp"

namespace greenloop::offline {

/// The states of a model, row by row, in orbits (James & Fatahalian 2003, section 2.3.2). An orbit's first row is the
/// state before its start; orbit 0 is the scene at rest.
struct PhasePortrait {
  std::vector<layout::OrbitRecord> orbits;  ///< continuations `none` until continue_orbits
  std::vector<bool> at_rest;                ///< of each orbit: it has come to rest in its last row
  std::vector<std::uint64_t> source_orbit;  ///< of the trajectories; that of orbit 0 means nothing
  Eigen::MatrixXd position;                 ///< q_u, m, [modes][rows]
  Eigen::MatrixXd velocity;                 ///< q_v, m/s, [modes][rows], backward differences
  std::vector<double> left_out;             ///< m^2, of each row
  double balance = 0;                       ///< rho, s: max |q_u| / max |q_v|; the time step if nothing moves

  [[nodiscard]] Eigen::Index rows() const { return position.cols(); }
  /// dist(x, y)^2 of equation 9, m^2.
  [[nodiscard]] double squared_distance(Eigen::Index x, Eigen::Index y) const {
    return (position.col(x) - position.col(y)).squaredNorm() +
           balance * balance * (velocity.col(x) - velocity.col(y)).squaredNorm();
  }
};

/// The rows of all orbits that are not held out. Work: linear in rows and modes.
[[nodiscard]] PhasePortrait phase_portrait(const TrajectoryScene& scene, const ReducedFrames& reduced);

/// An orbit that ends neither at rest nor near a state of another one of its impulse.
struct DeadEnd {
  std::uint64_t source_orbit = 0;
  double distance = 0;  ///< m, to the nearest state; infinite: there is no other orbit
};

/// Says where each orbit that has not come to rest goes on: in the nearest state of an orbit of its impulse, in the
/// first three quarters of it, so that playing never ends. Where an impulse has orbits that come to rest, every
/// continuation leads there at last: links are taken in order of their distance, from orbits that do (Prim). Orbits
/// without a state within `limit` (m) are taken out, with everything that is theirs, and returned. Throws
/// std::runtime_error if an impulse is left without orbits. Work: rows * orbits * modes.
std::vector<DeadEnd> continue_orbits(const std::vector<Impulse>& impulses, double limit, PhasePortrait& portrait);

/// [rows][impulses]: the orbit of that impulse whose start is nearest, by the table of successions. Work: rows * orbits
/// * modes.
[[nodiscard]] std::vector<layout::ReferenceRecord> nearest_references(const PhasePortrait& portrait,
                                                                      const std::vector<std::uint8_t>& successions,
                                                                      std::size_t impulses);

}  // namespace greenloop::offline
