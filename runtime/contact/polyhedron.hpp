#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

class Arena;

/// How far a place is outside of a shape, and which way out leads.
struct SignedDistance {
  double distance = 0;  ///< m, to the shape's surface; negative inside
  Double3 normal;       ///< unit, outwards; where several are nearest, that of the first
};

/// A closed convex surface of triangles. Its own copy of them is in the caller's memory, which must outlive it.
class ConvexPolyhedron {
 public:
  struct Created;

  static constexpr std::uint32_t max_vertices = 128;
  static constexpr std::uint32_t max_faces = 2 * max_vertices - 4;  ///< Euler's, of so many vertices
  /// Of the largest distance between two vertices along an axis: how far vertices may stand out from a face's plane.
  static constexpr double flatness = 1e-5;

  /// Vertices counter-clockwise seen from outside. A face with more corners is several triangles in one plane.
  struct Face {
    std::uint32_t vertex[3] = {};
  };

  enum class Error : std::uint8_t {
    none,
    bad_count,   ///< fewer than four vertices or faces, or more than there may be
    not_finite,  ///< a vertex is not finite, or a coordinate of more than 1e6 m
    bad_index,   ///< a face names no vertex
    flat_face,   ///< a face has no area
    not_closed,  ///< an edge is not that of just two faces that run along it in opposite directions
    inward,      ///< faces are clockwise seen from outside, or enclose nothing
    not_convex,  ///< a vertex stands out from a face's plane
    memory_too_small,
    memory_misaligned,
  };

  /// Encloses nothing; of use only after `create`.
  ConvexPolyhedron() = default;

  /// Bytes, constant work.
  [[nodiscard]] static std::size_t required(std::size_t vertices, std::size_t faces) noexcept;

  /// vertex: m, in the tool's frame. memory: 64-byte aligned. Start-up; quadratic in vertices and faces.
  [[nodiscard]] static Created create(std::span<const Double3> vertex, std::span<const Face> face,
                                      std::span<std::byte> memory) noexcept;

  [[nodiscard]] std::span<const Double3> vertices() const noexcept { return {vertex_, vertices_}; }
  [[nodiscard]] std::uint32_t face_count() const noexcept { return faces_; }

  /// Of a place (m) in the tool's frame: inside to the nearest plane of a face, outside to the nearest point of a face
  /// that is seen from there. For the loop; work: all faces.
  [[nodiscard]] SignedDistance distance(const Double3& place) const noexcept;

 private:
  struct Plane {
    Double3 normal;
    double offset = 0;
  };

  void carve(Arena& arena, std::size_t vertices, std::size_t faces) noexcept;
  [[nodiscard]] double size() const noexcept;
  [[nodiscard]] SignedDistance from_outside(const Double3& place, std::uint32_t facing) const noexcept;

  std::uint32_t vertices_ = 0, faces_ = 0;
  Double3* vertex_ = nullptr;
  Face* face_ = nullptr;
  Plane* plane_ = nullptr;
};

struct ConvexPolyhedron::Created {
  Error error = Error::none;
  std::uint32_t at = 0;  ///< the vertex or face, by its number, that the error is about
  std::size_t requested = 0, available = 0, missing = 0;  ///< bytes
  ConvexPolyhedron polyhedron;
  explicit operator bool() const noexcept { return error == Error::none; }
};

}  // namespace greenloop
