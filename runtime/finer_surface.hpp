#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/surface.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct FinerSurfaceParts;  // what it keeps in its memory: runtime/display/parts.hpp

/// A surface split further than its model, for pictures: added level k has 4^k times the triangles of the surface's own
/// level, and its nodes first. Midpoints lie on the surface's own triangles; Loop's rule (Loop 1987, with Warren's
/// weights) smooths, and moves the nodes too (James & Pai 2003, section 9.2). Lives in the caller's memory. One thread
/// at a time; no heap, locks, system calls or exceptions; the same questions give the same bits everywhere.
class FinerSurface {
 public:
  static constexpr std::uint32_t most_added = 4;

  enum class Rule : std::uint8_t { midpoint, loop };

  enum class Error : std::uint8_t {
    none,
    bad_options,          ///< no rule, or more levels than most_added
    unsupported_surface,  ///< an edge is not that of just two triangles, or 2^30 triangles and more
    memory_too_small,
    memory_misaligned,
  };

  struct Options {
    std::uint32_t added = 1;  ///< levels, 0..most_added
    Rule rule = Rule::loop;
  };

  struct Created;

  /// Bytes; 0: `create` would refuse for another reason than memory. Start-up; constant work.
  [[nodiscard]] static std::size_t required(const Surface& surface, const Options& options) noexcept;

  /// The surface must outlive it. memory: 64-byte aligned. Start-up; n log n in the triangles of the last level but
  /// one.
  [[nodiscard]] static Created create(const Surface& surface, const Options& options,
                                      std::span<std::byte> memory) noexcept;

  [[nodiscard]] std::uint32_t added() const noexcept;
  /// Of added level k; 0 above `added`. For the loop; constant work.
  [[nodiscard]] std::uint32_t vertex_count(std::uint32_t k) const noexcept;
  [[nodiscard]] std::uint32_t triangle_count(std::uint32_t k) const noexcept;

  /// Vertices of triangle t < triangle_count(k), counter-clockwise from outside; those of the next level are 4t..4t+3,
  /// as of Surface::triangle. For the loop; constant work.
  [[nodiscard]] Surface::Triangle triangle(std::uint32_t k, std::uint32_t t) const noexcept;

  /// Where the vertices of added level k are, m. displacement: of at least the surface's nodes, m; empty: at rest.
  /// position: [vertex_count(k)]. False, and nothing written, on another size or level. For the loop; work: about 40
  /// operations a vertex of level k.
  bool positions(std::uint32_t k, std::span<const Vec4> displacement, std::span<Vec4> position) const noexcept;

  /// Outward unit normals of level k at these positions, the mean of the adjacent triangles' by area; 0 where there is
  /// none. Sizes: [vertex_count(k)] both; false, and nothing written, if they are not. For the loop; work: 60
  /// operations a triangle.
  bool normals(std::uint32_t k, std::span<const Vec4> position, std::span<Vec4> normal) const noexcept;

  /// The surface that it splits.
  [[nodiscard]] const Surface& surface() const noexcept;

 private:
  FinerSurfaceParts* parts_ = nullptr;
};

struct FinerSurface::Created {
  Error error = Error::none;
  std::size_t requested = 0, available = 0, missing = 0;  ///< bytes
  FinerSurface surface;
  explicit operator bool() const noexcept { return error == Error::none; }
};

}  // namespace greenloop
