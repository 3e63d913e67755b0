// Finer pictures and relief in C.
#include <bit>
#include <cstddef>
#include <type_traits>

#include "runtime/bound_mesh.hpp"
#include "runtime/c_values.hpp"
#include "runtime/finer_surface.hpp"
#include "runtime/greenloop_display.h"
#include "runtime/look.hpp"
#include "runtime/relief.hpp"

namespace greenloop {
namespace {

static_assert(same(GREENLOOP_FINER_MIDPOINT, FinerSurface::Rule::midpoint) &&
              same(GREENLOOP_FINER_LOOP, FinerSurface::Rule::loop) &&
              same(GREENLOOP_FINER_BAD_OPTIONS, FinerSurface::Error::bad_options) &&
              same(GREENLOOP_FINER_UNSUPPORTED_SURFACE, FinerSurface::Error::unsupported_surface) &&
              same(GREENLOOP_FINER_MEMORY_TOO_SMALL, FinerSurface::Error::memory_too_small) &&
              same(GREENLOOP_FINER_MEMORY_MISALIGNED, FinerSurface::Error::memory_misaligned));
static_assert(same(GREENLOOP_BOUND_BAD_VERTEX, BoundMesh::Error::bad_vertex) &&
              same(GREENLOOP_BOUND_MEMORY_TOO_SMALL, BoundMesh::Error::memory_too_small) &&
              same(GREENLOOP_BOUND_MEMORY_MISALIGNED, BoundMesh::Error::memory_misaligned));
static_assert(sizeof(FinerSurface) == sizeof(void*) && std::is_trivially_copyable_v<FinerSurface> &&
              sizeof(BoundMesh) == sizeof(void*) && std::is_trivially_copyable_v<BoundMesh>);
static_assert(sizeof(ContactBody::Contact) == sizeof(greenloop_touch));  // and all of it: contact_body_c_api.cpp

Surface surface_of(const greenloop_surface* surface) {
  return std::bit_cast<Surface>(reinterpret_cast<const SurfaceParts*>(surface));
}
FinerSurface finer_of(const greenloop_finer_surface* surface) {
  return std::bit_cast<FinerSurface>(reinterpret_cast<const FinerSurfaceParts*>(surface));
}
BoundMesh mesh_of(const greenloop_bound_mesh* mesh) {
  return std::bit_cast<BoundMesh>(reinterpret_cast<const BoundMeshParts*>(mesh));
}

FinerSurface::Options options_of(std::uint32_t added, greenloop_finer_rule rule) {
  const bool is_rule = rule == GREENLOOP_FINER_MIDPOINT || rule == GREENLOOP_FINER_LOOP;
  return {is_rule ? added : FinerSurface::most_added + 1, static_cast<FinerSurface::Rule>(rule)};
}

bool is_aligned(const float* vectors) { return reinterpret_cast<std::uintptr_t>(vectors) % alignof(Vec4) == 0; }

template <class T, class From>
std::span<T> vectors(From* floats, std::size_t count) {
  return {reinterpret_cast<T*>(floats), floats == nullptr ? 0 : count};
}
std::span<const std::uint8_t> flags(const std::uint8_t* seen, std::uint32_t count) {
  return {seen, seen == nullptr ? 0 : count};
}

constexpr const char* finer_error_texts[] = {
    "the finer surface was created",
    "more than 4 added levels, or no rule",
    "an edge of the surface is not that of just two triangles, or there are 2^30 triangles and more",
    "the memory is too small: give it as many bytes as were requested",
    "the memory is not 64-byte aligned",
};

constexpr const char* bound_error_texts[] = {
    "the mesh was bound",
    "a vertex is NaN or infinite, or there are 2^30 and more",
    "the memory is too small: give it as many bytes as were requested",
    "the memory is not 64-byte aligned",
};

}  // namespace
}  // namespace greenloop

using namespace greenloop;

size_t greenloop_finer_surface_required(const greenloop_surface* surface, uint32_t added, greenloop_finer_rule rule) {
  return FinerSurface::required(surface_of(surface), options_of(added, rule));
}

greenloop_finer_created greenloop_finer_surface_create(const greenloop_surface* surface, uint32_t added,
                                                       greenloop_finer_rule rule, void* memory, size_t bytes) {
  const auto created =
      FinerSurface::create(surface_of(surface), options_of(added, rule), {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_finer_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_finer_surface*>(std::bit_cast<FinerSurfaceParts*>(created.surface))};
}

uint32_t greenloop_finer_surface_vertex_count(const greenloop_finer_surface* surface, uint32_t k) {
  return finer_of(surface).vertex_count(k);
}

uint32_t greenloop_finer_surface_triangle_count(const greenloop_finer_surface* surface, uint32_t k) {
  return finer_of(surface).triangle_count(k);
}

greenloop_triangle greenloop_finer_surface_triangle(const greenloop_finer_surface* surface, uint32_t k, uint32_t t) {
  return std::bit_cast<greenloop_triangle>(finer_of(surface).triangle(k, t));
}

int greenloop_finer_surface_positions(const greenloop_finer_surface* surface, uint32_t k, const float* displacement,
                                      uint32_t nodes, float* position, uint32_t count) {
  if (!is_aligned(displacement) || !is_aligned(position)) return 0;
  return finer_of(surface).positions(k, vectors<const Vec4>(displacement, nodes), vectors<Vec4>(position, count)) ? 1
                                                                                                                  : 0;
}

int greenloop_finer_surface_normals(const greenloop_finer_surface* surface, uint32_t k, const float* position,
                                    float* normal, uint32_t count) {
  if (!is_aligned(position) || !is_aligned(normal)) return 0;
  return finer_of(surface).normals(k, vectors<const Vec4>(position, count), vectors<Vec4>(normal, count)) ? 1 : 0;
}

size_t greenloop_bound_mesh_required(const greenloop_surface* surface, size_t vertices) {
  return BoundMesh::required(surface_of(surface), vertices);
}

greenloop_bound_created greenloop_bound_mesh_create(const greenloop_surface* surface, const float* vertex,
                                                    size_t vertices, void* memory, size_t bytes) {
  const auto created = BoundMesh::create(surface_of(surface), vectors<const Vec3>(vertex, vertices),
                                         {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_bound_error>(created.error),
          created.at,
          created.requested,
          created.available,
          created.missing,
          reinterpret_cast<greenloop_bound_mesh*>(std::bit_cast<BoundMeshParts*>(created.mesh))};
}

uint32_t greenloop_bound_mesh_vertex_count(const greenloop_bound_mesh* mesh) { return mesh_of(mesh).vertex_count(); }

int greenloop_bound_mesh_positions(const greenloop_bound_mesh* mesh, const float* displacement, const float* normal,
                                   uint32_t nodes, const uint8_t* seen, uint32_t triangles, float* position,
                                   uint32_t count) {
  if (!is_aligned(displacement) || !is_aligned(normal) || !is_aligned(position)) return 0;
  return mesh_of(mesh).positions(vectors<const Vec4>(displacement, nodes), vectors<const Vec4>(normal, nodes),
                                 flags(seen, triangles), vectors<Vec4>(position, count))
             ? 1
             : 0;
}

greenloop_seen greenloop_look_at(const greenloop_surface* surface, const float* displacement, uint32_t nodes,
                                 greenloop_look look, uint8_t* seen, uint32_t triangles) {
  if (!is_aligned(displacement)) return {0, 0};
  const Look same{{look.eye[0], look.eye[1], look.eye[2]},
                  {look.direction[0], look.direction[1], look.direction[2]},
                  look.cosine,
                  look.detail,
                  look.turned};
  const Seen found = look_at(surface_of(surface), vectors<const Vec4>(displacement, nodes), same, {seen, triangles});
  return {found.triangles, found.halvings};
}

int greenloop_relief_slopes(const float* normal, const float* detail, float* slope, uint32_t count) {
  if (!is_aligned(normal)) return 0;
  return relief_slopes(vectors<const Vec4>(normal, count), vectors<const Vec3>(detail, count),
                       vectors<Vec3>(slope, count))
             ? 1
             : 0;
}

double greenloop_relief_friction(const greenloop_finer_surface* surface, const float* slope, uint32_t count,
                                 double friction, const double* way, const greenloop_touch* contacts, size_t touches) {
  return relief_friction(finer_of(surface), vectors<const Vec3>(slope, count), friction, {way[0], way[1], way[2]},
                         {reinterpret_cast<const ContactBody::Contact*>(contacts), touches});
}

const char* greenloop_finer_error_text(greenloop_finer_error error) { return text_at(finer_error_texts, error); }
const char* greenloop_bound_error_text(greenloop_bound_error error) { return text_at(bound_error_texts, error); }
