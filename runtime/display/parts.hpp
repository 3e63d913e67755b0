#pragma once

#include <cstdint>

#include "runtime/finer_surface.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// The edge that a vertex halves, and the third corners of the two triangles at it.
struct HalvedEdge {
  std::uint32_t end[2];
  std::uint32_t wing[2];
};

/// What Loop's rule gives a vertex of itself and of each of its neighbours.
struct LoopWeight {
  float own, neighbour;
};

/// Everything that a finer surface keeps in its memory.
struct FinerSurfaceParts {
  Surface surface;
  FinerSurface::Options options;
  std::uint32_t vertex_count[FinerSurface::most_added + 1] = {};
  std::uint32_t triangle_count[FinerSurface::most_added + 1] = {};
  HalvedEdge* halved = nullptr;           ///< of the vertices from vertex_count[0] on
  LoopWeight* weight = nullptr;           ///< [vertex_count[0]]; vertices of added levels have six neighbours
  Surface::Triangle* triangle = nullptr;  ///< [triangle_count[added]]
  Vec4* sum = nullptr;                    ///< [vertex_count[added - 1]] of neighbours, while Loop's rule is applied
  std::uint32_t* half_edge = nullptr;     ///< [3 triangle_count[added - 1]] at the start: 3 t + i, of triangle t
  std::uint32_t* scratch = nullptr;       ///< the same

  /// Triangle t of added level k, as FinerSurface::triangle. Constant work.
  [[nodiscard]] Surface::Triangle triangle_at(std::uint32_t k, std::uint32_t t) const noexcept {
    const std::uint32_t halvings = 2 * (options.added - k);
    const std::uint32_t step = ((std::uint32_t{1} << halvings) - 1) / 3;
    const Surface::Triangle* const children = triangle + (std::size_t{t} << halvings);
    return {{children[0].node[0], children[step].node[1], children[std::size_t{2} * step].node[2]}};
  }

  /// Counts of all levels; false if there are too many triangles.
  [[nodiscard]] bool count(const Surface& of, const FinerSurface::Options& wanted) noexcept;
  /// After `count`.
  void carve(Arena& arena) noexcept;
  /// Splits level k into the next; false if an edge is not that of just two triangles. n log n.
  [[nodiscard]] bool split(std::uint32_t k) noexcept;
  /// After the first split, if there is one.
  void weigh() noexcept;
};

}  // namespace greenloop
