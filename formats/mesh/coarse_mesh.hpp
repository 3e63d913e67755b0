#pragma once

#include <cstddef>

#include "formats/mesh/semi_regular_mesh.hpp"

namespace greenloop {

/// The mesh of levels 0 .. level, with the finest positions. level: 0..finest_level.
[[nodiscard]] SemiRegularMesh coarse_mesh(const SemiRegularMesh& mesh, std::size_t level);

}  // namespace greenloop
