#pragma once

namespace greenloop {

/// How displacements vary within a tetrahedron.
enum class Elements {
  linear,
  quadratic  ///< within a tetrahedron and along its edges; forces and displacements of surface nodes: docs/solving.md
};

}  // namespace greenloop
