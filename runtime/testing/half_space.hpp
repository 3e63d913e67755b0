#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "runtime/friction/contact_problem.hpp"
#include "runtime/testing/carved.hpp"

namespace greenloop {

/// An elastic half-space z > 0 (Johnson, Contact Mechanics, sections 3.2, 3.6 and appendix 2).
struct HalfSpace {
  double shear;  ///< Pa
  double poisson;

  /// Displacement, `offset` away from its middle, per force that spreads evenly over a rectangle of the surface, m/N.
  [[nodiscard]] Eigen::Matrix3d influence(const Eigen::Vector2d& offset, const Eigen::Vector2d& edges) const;
};

/// A half-space that is pressed on square cells of its surface: within each a force spreads evenly, and
/// displacements are those of the cells' middles.
struct HalfSpacePatch {
  std::uint32_t across;  ///< cells along x and y
  double cell;           ///< m, of an edge
  double shear;          ///< Pa
  double poisson;

  [[nodiscard]] std::uint32_t count() const { return across * across; }
  /// Of a cell's middle, m from that of the patch.
  [[nodiscard]] Eigen::Vector2d place(std::uint32_t i) const;
  /// Displacement of the middle of one cell per force on another, `offset` away, m/N.
  [[nodiscard]] Eigen::Matrix3d influence(const Eigen::Vector2d& offset) const;
  /// E / (1 - nu^2), Pa.
  [[nodiscard]] double plane_modulus() const { return 2 * shear / (1 - poisson); }
};

/// A contact problem with the memory that it needs.
class ContactBench {
 public:
  explicit ContactBench(std::uint32_t candidates);
  explicit ContactBench(const HalfSpacePatch& patch);

  /// Sets blocks (i, j) and (j, i), of which one is the transposed other.
  void set_block(std::uint32_t i, std::uint32_t j, const Eigen::Matrix3d& block);
  [[nodiscard]] Eigen::MatrixXd compliance() const;

  ContactAnswer solve(const ContactAccuracy& accuracy = {}, std::uint64_t work = ~std::uint64_t{0});
  [[nodiscard]] Eigen::Vector3d total() const;
  [[nodiscard]] ContactProblem& problem() { return *problem_; }

  std::vector<ContactCandidate> candidates;
  std::vector<Vec4> force;
  std::vector<Vec4> displacement;
  std::vector<ContactState> state;

 private:
  std::vector<Block<3>> block_;
  Carved<ContactProblem> problem_;
};

/// A tool that is moved without turning, in steps: slips are those of a step.
class MovingTool {
 public:
  explicit MovingTool(ContactBench& bench) : bench_(bench), shift_(bench.force.size(), Eigen::Vector3d::Zero()) {}

  /// gap: of every candidate, along its normal, without contact forces; way: m, of the tool in this step.
  ContactAnswer step(const std::vector<double>& gap, const Eigen::Vector3d& way, const ContactAccuracy& accuracy = {});

 private:
  ContactBench& bench_;
  std::vector<Eigen::Vector3d> shift_;  ///< of each point by the forces, at the last step
};

}  // namespace greenloop
