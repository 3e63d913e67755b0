#pragma once

#include <vector>

#include "offline/scene/rigid_shape.hpp"

namespace greenloop::offline {

/// What sheets are like, in place of a material, and what is rigid around them (docs/simulating.md).
struct Sheet {
  double density = 0;     ///< kg/m^2
  double stretch = 0;     ///< N/m
  double bend = 0;        ///< N m
  double thickness = 0;   ///< m
  double friction = 0.3;  ///< 0..1
  double damping = 0;     ///< 1/s
  double air = 0;         ///< 1/s
  double settling = 2;    ///< s
  int substeps = 20;
  int finer = 0;  ///< times that they are split for what is shown, 0..4
  std::vector<RigidShape> rigid;
};

}  // namespace greenloop::offline
