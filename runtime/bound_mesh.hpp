#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/surface.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct BoundMeshParts;  // what it keeps in its memory

/// A mesh of the caller's, such as the one that the model was made of, bound to a body's surface: each vertex keeps its
/// place relative to the nearest point of the surface at rest, in a frame that turns with the surface (displaced
/// surfaces: Lee, Moreton & Hoppe 2000; James & Pai 2003, section 9.2). Detail that the model's mesh is too coarse for
/// so goes along with the body. Lives in the caller's memory; immutable; no heap, locks, system calls or exceptions;
/// the same questions give the same bits everywhere.
class BoundMesh {
 public:
  enum class Error : std::uint8_t {
    none,
    bad_vertex,  ///< one that is not finite, or 2^30 and more
    memory_too_small,
    memory_misaligned,
  };

  struct Created;

  /// Bytes for so many vertices: 24 each, and 16 a node while it is made. 0: too many. Start-up; constant work.
  [[nodiscard]] static std::size_t required(const Surface& surface, std::size_t vertices) noexcept;

  /// vertex: m, in the frame of the model, at rest; how they are joined is the caller's. The surface must outlive it.
  /// memory: 64-byte aligned. Start-up; a nearest point of the surface each.
  [[nodiscard]] static Created create(const Surface& surface, std::span<const Vec3> vertex,
                                      std::span<std::byte> memory) noexcept;

  [[nodiscard]] std::uint32_t vertex_count() const noexcept;

  /// Where the vertices are, m. displacement: of at least the surface's nodes, m; normal: what Surface::normals says
  /// of the surface's level under it. seen: one flag for each triangle of a level of the surface (look_at), which says
  /// which level by its size; empty: all are seen. Vertices over what is not seen are left as they were. position:
  /// [vertex_count()]. False, and nothing written, on another size. For the loop; work: 120 operations a vertex.
  bool positions(std::span<const Vec4> displacement, std::span<const Vec4> normal, std::span<const std::uint8_t> seen,
                 std::span<Vec4> position) const noexcept;

  /// The triangle of the surface's own level that a vertex lies over. vertex: below vertex_count(). For the loop.
  [[nodiscard]] std::uint32_t triangle(std::uint32_t vertex) const noexcept;

 private:
  BoundMeshParts* parts_ = nullptr;
};

struct BoundMesh::Created {
  Error error = Error::none;
  std::size_t at = 0;                                     ///< the vertex that the error is about
  std::size_t requested = 0, available = 0, missing = 0;  ///< bytes
  BoundMesh mesh;
  explicit operator bool() const noexcept { return error == Error::none; }
};

}  // namespace greenloop
