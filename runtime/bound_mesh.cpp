#include "runtime/bound_mesh.hpp"

#include <cmath>
#include <new>

#include "runtime/algebra/double3.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/memory/fit.hpp"
#include "runtime/surface/parts.hpp"

namespace greenloop {

struct BoundVertex {
  std::uint32_t triangle;
  float weight[2];  ///< of its first and second corner
  float offset[3];  ///< m, along the axes of the frame there
};
static_assert(sizeof(BoundVertex) == 24);

struct BoundMeshParts {
  Surface surface;
  std::uint32_t count = 0;
  BoundVertex* vertex = nullptr;  ///< [count]
  Vec4* normal = nullptr;         ///< [nodes] at rest, at the start
};

namespace {

constexpr std::size_t most_vertices = std::size_t{1} << 30;

BoundMeshParts* carve(Arena& arena, const Surface& surface, std::size_t vertices, BoundMeshParts& parts) {
  auto* const place = arena.take<BoundMeshParts>(1);
  parts.surface = surface;
  parts.count = static_cast<std::uint32_t>(vertices);
  parts.vertex = arena.take<BoundVertex>(vertices);
  parts.normal = arena.take<Vec4>(surface.node_count(surface.level()));
  return place;
}

Double3 exact(const Vec4& v) { return {v.x, v.y, v.z}; }

// A point of the displaced surface, and axes there: two along it and its normal, interpolated between the corners'.
struct Frame {
  Double3 origin;
  Double3 axis[3];
};

Frame frame_at(const SurfaceParts& surface, std::span<const Vec4> displacement, std::span<const Vec4> normal,
               const BoundVertex& vertex) {
  const Surface::Triangle& triangle = surface.triangles[vertex.triangle];
  const double weight[3] = {vertex.weight[0], vertex.weight[1], 1 - double{vertex.weight[0]} - vertex.weight[1]};
  Double3 corner[3], upright;
  Frame frame;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t node = triangle.node[k];
    const float* const x = surface.nodes[node].position;
    corner[k] = Double3{x[0], x[1], x[2]};
    if (!displacement.empty()) corner[k] += exact(displacement[node]);
    frame.origin += weight[k] * corner[k];
    upright += weight[k] * exact(normal[node]);
  }
  frame.axis[2] = unit(upright);
  const Double3 edge = corner[1] - corner[0];
  frame.axis[0] = unit(edge - dot(edge, frame.axis[2]) * frame.axis[2]);
  frame.axis[1] = cross(frame.axis[2], frame.axis[0]);
  return frame;
}

// whether a number that is not finite is among them
bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

BoundVertex bound(const Surface& surface, std::span<const Vec4> normal, const Vec3& place) {
  const Surface::NearestPoint nearest = surface.nearest_point(place);
  BoundVertex vertex{nearest.triangle, {nearest.weight[0], nearest.weight[1]}, {}};
  const Frame frame = frame_at(surface.parts(), {}, normal, vertex);
  const Double3 way = Double3{place.x, place.y, place.z} - frame.origin;
  for (int k = 0; k < 3; ++k) vertex.offset[k] = static_cast<float>(dot(way, frame.axis[k]));
  return vertex;
}

// the level of which there is one flag for each triangle, or one more than the surface's
std::uint32_t level_of(const Surface& surface, std::size_t flags) {
  std::uint32_t level = 0;
  while (level <= surface.level() && flags != surface.triangle_count(level)) ++level;
  return level;
}

}  // namespace

std::size_t BoundMesh::required(const Surface& surface, std::size_t vertices) noexcept {
  if (vertices >= most_vertices) return 0;
  Arena counting;
  BoundMeshParts parts;
  static_cast<void>(carve(counting, surface, vertices, parts));
  return counting.bytes() <= SIZE_MAX ? static_cast<std::size_t>(counting.bytes()) : 0;
}

BoundMesh::Created BoundMesh::create(const Surface& surface, std::span<const Vec3> vertex,
                                     std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  created.requested = required(surface, vertex.size());
  if (created.requested == 0) {
    created.error = Error::bad_vertex;
    created.at = most_vertices;
    return created;
  }
  if (!memory_fits(memory, Error::memory_too_small, Error::memory_misaligned, created)) return created;
  Arena arena(memory.data());
  BoundMeshParts made;
  auto* const parts = new (carve(arena, surface, vertex.size(), made)) BoundMeshParts(made);
  const std::span<Vec4> normal{parts->normal, surface.node_count(surface.level())};
  static_cast<void>(surface.normals(surface.level(), {}, normal));
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    if (!is_finite(vertex[i])) {
      created.error = Error::bad_vertex;
      created.at = i;
      return created;
    }
    parts->vertex[i] = bound(surface, normal, vertex[i]);
  }
  created.mesh.parts_ = parts;
  return created;
}

std::uint32_t BoundMesh::vertex_count() const noexcept { return parts_->count; }

std::uint32_t BoundMesh::triangle(std::uint32_t vertex) const noexcept { return parts_->vertex[vertex].triangle; }

bool BoundMesh::positions(std::span<const Vec4> displacement, std::span<const Vec4> normal,
                          std::span<const std::uint8_t> seen, std::span<Vec4> position) const noexcept {
  const Surface& surface = parts_->surface;
  const std::uint32_t nodes = surface.node_count(surface.level());
  const std::uint32_t level = seen.empty() ? surface.level() : level_of(surface, seen.size());
  const bool fits = position.size() == parts_->count && normal.size() >= nodes && level <= surface.level() &&
                    (displacement.empty() || displacement.size() >= nodes);
  if (!fits) return false;
  const std::uint32_t halvings = 2 * (surface.level() - level);
  for (std::uint32_t i = 0; i < parts_->count; ++i) {
    const BoundVertex& vertex = parts_->vertex[i];
    if (!seen.empty() && seen[vertex.triangle >> halvings] == 0) continue;
    const Frame frame = frame_at(surface.parts(), displacement, normal, vertex);
    Double3 place = frame.origin;
    for (int k = 0; k < 3; ++k) place += double{vertex.offset[k]} * frame.axis[k];
    position[i] = {static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z), 0};
  }
  return true;
}

}  // namespace greenloop
