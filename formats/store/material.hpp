#pragma once

namespace greenloop {

/// A homogeneous isotropic linear elastic material.
struct Material {
  double young = 0;    ///< Young's modulus E [Pa], > 0
  double poisson = 0;  ///< Poisson's ratio, -1 < nu < 0.5; linear tetrahedra lock as it nears 0.5, see docs/solving.md
};

}  // namespace greenloop
