#pragma once

#include <cstdint>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline::examples {

/// A closed cage and which of its vertices stay where they are.
struct Cage {
  TriangleMesh mesh;
  std::vector<std::uint8_t> corner;  ///< per vertex, nonzero = a pointed tip
};

/// The cage split `levels` times by Loop's rules (1987; weights of Warren 1995), but for its corners: triangle t of a
/// level becomes 4t .. 4t+3.
[[nodiscard]] TriangleMesh subdivide(Cage cage, int levels);

}  // namespace greenloop::offline::examples
