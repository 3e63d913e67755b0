#pragma once

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline::examples {

/// A cloth 60 cm high and 52 cm wide in three pleats, `cells` squares along each side (6 to 200), before a door in the
/// plane z = 0 that turns about the y axis; y points up. In metres.
[[nodiscard]] TriangleMesh cloth(int cells);

/// Fourteen creased leaves, some 22 cm long, of `cells` squares along each (6 to 200) and a fifth of that across, above
/// the middle of a pot; y points up. In metres.
[[nodiscard]] TriangleMesh plant(int cells);

}  // namespace greenloop::offline::examples
