#pragma once

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline::examples {

/// An animal on four legs with a long neck, a tail and spines on its back and tail, 8 units long; y points up. A
/// cage of cubes, subdivided `levels` times (0 to 6); from two levels on with a scaly skin. Closed, without crossings.
[[nodiscard]] TriangleMesh animal(int levels);

}  // namespace greenloop::offline::examples
