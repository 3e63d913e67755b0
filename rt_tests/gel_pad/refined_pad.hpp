#pragma once

#include <Eigen/Core>
#include <vector>

#include "formats/store/material.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "rt_tests/gel_pad/upper_side.hpp"
#include "runtime/contact/tool.hpp"

namespace greenloop::gel_pad {

/// A gel pad of quadratic elements, bonded below, or its quarter x, y >= 0 on whose symmetry planes nothing moves
/// across: a rigid tool without friction is pressed into it at the axis. The laws of contact in double precision, by a
/// plain iteration on dense matrices. Shares with the loop the shapes of tools and the elements' stiffness, and nothing
/// else.
class RefinedPad {
 public:
  /// planes: of the pad, or of the quarter from 0 on. reach: m, how far from the axis along x and y a tool may touch.
  RefinedPad(const offline::testing::Planes& planes, const Material& material, double reach);

  /// Signorini's law at every place, between its displaced position and the tool: gap and force along the shape's
  /// normal there, neither negative, one of them zero. The force is that of the whole pad.
  /// Throws std::runtime_error if the iteration does not settle.
  [[nodiscard]] Pressed press(const Shape& shape, const Pose& pose) const;

 private:
  bool is_quarter_;
  SidePlanes planes_;                    // as far as a tool may touch
  std::vector<Eigen::Vector3d> places_;  // m, their crossings
  std::vector<double> area_;             // m^2, that each place's force is spread over
  Eigen::MatrixXd compliance_;           // [3 places, 3 places] m/N
};

/// The part of a pad's planes from its axis on.
[[nodiscard]] offline::testing::Planes quarter(const offline::testing::Planes& planes);

}  // namespace greenloop::gel_pad
