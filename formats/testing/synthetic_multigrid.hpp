#pragma once

#include <cstdint>

#include "formats/write/multigrid.hpp"

namespace greenloop {

/// What a synthetic multigrid model is like.
struct SyntheticMultigrid {
  std::uint32_t cells = 2;  ///< of the beam, along x
  std::uint32_t grids = 3;  ///< with the coarsest, 1 to 3
  layout::Strain strain = layout::Strain::corotational;
};

/// A beam of cubes of 1 cm, six tetrahedra each, held at x = 0. Its grids are such in form alone: operators of their
/// diagonals, so that a cycle is what dividing by them is. The same everywhere. For tests.
[[nodiscard]] MultigridData synthetic_multigrid(const SyntheticMultigrid& options);

}  // namespace greenloop
