#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/surface.hpp"
#include "runtime/surface/triangle_tree.hpp"

namespace greenloop {

/// Everything that a surface keeps in its memory.
struct SurfaceParts {
  std::uint32_t level = 0;                            ///< the finest
  std::uint32_t node_count[layout::max_levels] = {};  ///< of levels 0..q
  std::uint32_t base_triangles = 0;
  layout::NodeRecord* nodes = nullptr;     ///< [node_count[level]]
  Surface::Triangle* triangles = nullptr;  ///< of the finest level
  TriangleTree tree;
};

/// Triangle t of mesh level `level`, at most the finest. Corner k is that of the first corner's, second's, third's
/// child at the finest level, so that finest triangles are all there need be. Constant work.
[[nodiscard]] inline Surface::Triangle triangle_of_level(const SurfaceParts& parts, std::uint32_t level,
                                                         std::uint32_t t) noexcept {
  const std::uint32_t halvings = 2 * (parts.level - level);
  const std::uint32_t step = ((std::uint32_t{1} << halvings) - 1) / 3;
  const Surface::Triangle* const children = parts.triangles + (std::size_t{t} << halvings);
  return {{children[0].node[0], children[step].node[1], children[std::size_t{2} * step].node[2]}};
}

}  // namespace greenloop
