#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/model.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct SurfaceParts;  // what a surface keeps in its memory: runtime/surface/parts.hpp

/// The undeformed surface of a model up to one of its mesh levels, ready to be asked what is nearest. Everything is in
/// the caller's memory, which must outlive it; the model need not. Immutable: any number of threads may ask at once.
/// Nothing here uses heap, locks, system calls or exceptions; the same questions give the same bits everywhere.
class Surface {
 public:
  struct Created;

  enum class Error : std::uint8_t {
    none,
    bad_level,          ///< the model has no such level
    unsupported_model,  ///< its refinement is not that of a subdivided triangulation, or it has too many triangles:
                        ///< 2^30
    memory_too_small,
    memory_misaligned,
  };

  struct Requirement {
    std::size_t bytes = 0;  ///< 0: `create` would refuse for another reason than memory
    std::size_t alignment = 64;
  };

  /// File indices of the corners, counter-clockwise seen from outside.
  struct Triangle {
    std::uint32_t node[3] = {};
  };

  struct NearestNode {
    std::uint32_t node = layout::none;  ///< file index; none: there is no such node, or the position is not finite
    double squared_distance = 0;        ///< m^2
  };

  struct NearestPoint {
    std::uint32_t triangle = layout::none;  ///< of the surface's own level; none: the position is not finite
    float weight[3] = {};                   ///< of its corners, in 0..1 with sum 1
    double squared_distance = 0;            ///< m^2
  };

  /// Bytes for levels 0..level, what is needed at start-up alone included. Start-up; constant work.
  [[nodiscard]] static Requirement required(const Model& model, std::uint32_t level) noexcept;

  /// Carves `memory` with the routine that `required` counts with. Start-up; n log n in the triangles.
  [[nodiscard]] static Created create(const Model& model, std::uint32_t level, std::span<std::byte> memory) noexcept;

  [[nodiscard]] std::uint32_t level() const noexcept;  ///< its own, the finest
  /// Nodes of levels 0..level, which come first; 0 above its own level. For the loop.
  [[nodiscard]] std::uint32_t node_count(std::uint32_t level) const noexcept;
  /// 4^level times the base triangles; 0 above its own level. For the loop.
  [[nodiscard]] std::uint32_t triangle_count(std::uint32_t level) const noexcept;

  /// Triangle t < triangle_count(level) of a level; those of the next are 4t..4t+3: at its first, second and third
  /// corner, then the middle one. For the loop; constant work.
  [[nodiscard]] Triangle triangle(std::uint32_t level, std::uint32_t t) const noexcept;
  /// All of them. `triangle`: [triangle_count(level)]; false, and nothing written, if it is not. For the loop; linear.
  bool triangles(std::uint32_t level, std::span<Triangle> triangle) const noexcept;

  /// Outward unit normals, the mean of the adjacent triangles' by area; 0 where there is none. `normal`:
  /// [node_count(level)], x y z 0. `displacement`: of at least as many nodes, m; empty: at rest. False, and nothing
  /// written, on another size or level. For the loop; work: 60 operations per triangle of the level.
  bool normals(std::uint32_t level, std::span<const Vec4> displacement, std::span<Vec4> normal) const noexcept;

  /// m^2, a third of the adjacent triangles of that level. `area`: [node_count(level)]; the rest as for `normals`.
  bool areas(std::uint32_t level, std::span<const Vec4> displacement, std::span<float> area) const noexcept;

  /// The node nearest to a position (m), at rest, among those of the surface's triangles that have all `flags`
  /// (layout::NodeFlag; a contact needs layout::node_touchable); of equally near ones the first. Exact for the
  /// distances as computed in double. For the loop; work: a few tens of triangles where one part of the surface is
  /// nearest and its nodes have the flags, and every one that is nearer than the answer; at most all: see
  /// docs/surface.md.
  [[nodiscard]] NearestNode nearest_node(Vec3 position, std::uint32_t flags = 0) const noexcept;

  /// The point of the surface nearest to a position (m), at rest; of equally near triangles the first. Exact, and of
  /// the same work, as nearest_node.
  [[nodiscard]] NearestPoint nearest_point(Vec3 position) const noexcept;

  /// What it keeps, for the rooms of the library.
  [[nodiscard]] const SurfaceParts& parts() const noexcept { return *parts_; }

 private:
  [[nodiscard]] bool fits(std::uint32_t level, std::span<const Vec4> displacement, std::size_t written) const noexcept;

  const SurfaceParts* parts_ = nullptr;
};

struct Surface::Created {
  Error error = Error::none;
  std::size_t requested = 0, available = 0, missing = 0;  ///< bytes
  Surface surface;
  explicit operator bool() const noexcept { return error == Error::none; }
};

}  // namespace greenloop
