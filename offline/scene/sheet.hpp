#pragma once

#include <vector>

#include "offline/scene/rigid_shape.hpp"

namespace greenloop::offline {

/// What sheets are like, in place of a material, and what is rigid around them (docs/simulating.md).
struct Sheet {
  double density = 0;             ///< kg/m^2
  double stretch = 0;             ///< N/m
  double bend = 0;                ///< N m
  double thickness = 0;           ///< m, vertices keep this distance from triangles that they do not belong to
  double friction = 0.3;          ///< 0..1
  double damping = 0;             ///< 1/s, rate at which velocities die out, seen from the support
  double air = 0;                 ///< 1/s, rate at which the normal part of the velocity through still air does
  double settling = 2;            ///< s, for which they hang under gravity before they are taken to be at rest
  int substeps = 20;              ///< of a time step
  int finer = 0;                  ///< times that they are split for what is shown, 0..4
  std::vector<RigidShape> rigid;  ///< part of the support: nothing gets into them
};

}  // namespace greenloop::offline
