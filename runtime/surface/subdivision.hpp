#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/surface.hpp"

namespace greenloop {

/// 4^level times the base triangles.
[[nodiscard]] inline std::uint64_t subdivided_count(const ModelView& view, std::uint32_t level) noexcept {
  return std::uint64_t{view.level[0].counts->base_triangle_count} << (2 * level);
}

/// Rebuilds the triangles of a mesh level from the base triangles and the nodes that halve their edges. Start-up.
class Subdivision {
 public:
  /// Room for what one level is looked up by.
  void carve(Arena& arena, const ModelView& view, std::uint32_t level) noexcept;

  /// triangles: [subdivided_count(view, level)]; false if an edge has no node that halves it; of several the first is
  /// taken. Work: n log n in the nodes and triangles.
  [[nodiscard]] bool fill(const ModelView& view, std::uint32_t level, Surface::Triangle* triangles) noexcept;

 private:
  bool split(const ModelView& view, std::uint32_t level, Surface::Triangle* triangles) noexcept;

  std::uint32_t* by_edge_ = nullptr;
  std::uint32_t* scratch_ = nullptr;
};

}  // namespace greenloop
