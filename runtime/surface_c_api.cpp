#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "runtime/c_values.hpp"
#include "runtime/mask.hpp"
#include "runtime/surface.hpp"

namespace greenloop {
namespace {

static_assert(GREENLOOP_NONE == layout::none && same(GREENLOOP_NODE_DOMAIN, layout::node_domain) &&
              same(GREENLOOP_NODE_TOUCHABLE, layout::node_touchable) &&
              same(GREENLOOP_NODE_FIXED, layout::node_fixed) && same(GREENLOOP_NODE_READ, layout::node_read));
static_assert(same(GREENLOOP_SURFACE_OK, Surface::Error::none) &&
              same(GREENLOOP_SURFACE_BAD_LEVEL, Surface::Error::bad_level) &&
              same(GREENLOOP_SURFACE_UNSUPPORTED_MODEL, Surface::Error::unsupported_model) &&
              same(GREENLOOP_SURFACE_MEMORY_TOO_SMALL, Surface::Error::memory_too_small) &&
              same(GREENLOOP_SURFACE_MEMORY_MISALIGNED, Surface::Error::memory_misaligned));
static_assert(sizeof(Surface::Triangle) == sizeof(greenloop_triangle) &&
              sizeof(layout::VertexRecord) == sizeof(greenloop_vertex));
static_assert(sizeof(Surface) == sizeof(void*) && std::is_trivially_copyable_v<Surface>);

Surface surface_of(const greenloop_surface* surface) {
  return std::bit_cast<Surface>(reinterpret_cast<const SurfaceParts*>(surface));
}

bool is_aligned(const float* vectors) { return reinterpret_cast<std::uintptr_t>(vectors) % alignof(Vec4) == 0; }

std::span<const Vec4> displaced(const float* displacement, std::uint32_t count) {
  return {reinterpret_cast<const Vec4*>(displacement), displacement == nullptr ? 0 : count};
}

Vec3 vec3(const float* position) { return {position[0], position[1], position[2]}; }

constexpr const char* error_texts[] = {
    "the surface was created",
    "the model has no such level",
    "the model is not one of a subdivided triangulation, or it has too many triangles",
    "the memory is too small: give it as many bytes as were requested",
    "the memory is not 64-byte aligned",
};

}  // namespace
}  // namespace greenloop

using namespace greenloop;

size_t greenloop_surface_required(const greenloop_model* model, uint32_t level) {
  return Surface::required(model_in(model), level).bytes;
}

greenloop_surface_created greenloop_surface_create(const greenloop_model* model, uint32_t level, void* memory,
                                                   size_t bytes) {
  const auto created = Surface::create(model_in(model), level, {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_surface_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_surface*>(
              const_cast<SurfaceParts*>(std::bit_cast<const SurfaceParts*>(created.surface)))};
}

uint32_t greenloop_surface_triangle_count(const greenloop_surface* surface, uint32_t level) {
  return surface_of(surface).triangle_count(level);
}

uint32_t greenloop_surface_node_count(const greenloop_surface* surface, uint32_t level) {
  return surface_of(surface).node_count(level);
}

int greenloop_surface_triangles(const greenloop_surface* surface, uint32_t level, greenloop_triangle* triangle,
                                uint32_t count) {
  return surface_of(surface).triangles(level, {reinterpret_cast<Surface::Triangle*>(triangle), count}) ? 1 : 0;
}

int greenloop_surface_normals(const greenloop_surface* surface, uint32_t level, const float* displacement,
                              float* normal, uint32_t count) {
  return is_aligned(displacement) && is_aligned(normal) &&
                 surface_of(surface).normals(level, displaced(displacement, count),
                                             {reinterpret_cast<Vec4*>(normal), count})
             ? 1
             : 0;
}

int greenloop_surface_areas(const greenloop_surface* surface, uint32_t level, const float* displacement, float* area,
                            uint32_t count) {
  return is_aligned(displacement) && surface_of(surface).areas(level, displaced(displacement, count), {area, count})
             ? 1
             : 0;
}

greenloop_mask greenloop_make_mask(const greenloop_surface* surface, uint32_t level, const greenloop_vertex* point,
                                   float radius, uint32_t* node, float* weight, size_t capacity) {
  MeshPoint mesh_point;
  for (std::size_t k = 0; k < 3; ++k) {
    mesh_point.node[k] = point->node[k];
    mesh_point.weight[k] = point->weight[k];
  }
  return std::bit_cast<greenloop_mask>(
      make_mask(surface_of(surface), level, mesh_point, radius, {node, capacity}, {weight, capacity}));
}

greenloop_nearest_node greenloop_surface_nearest_node(const greenloop_surface* surface, const float* position,
                                                      uint32_t flags) {
  const auto [node, squared_distance] = surface_of(surface).nearest_node(vec3(position), flags);
  return {node, squared_distance};
}

greenloop_nearest_point greenloop_surface_nearest_point(const greenloop_surface* surface, const float* position) {
  const auto [triangle, weight, squared_distance] = surface_of(surface).nearest_point(vec3(position));
  return {triangle, {weight[0], weight[1], weight[2]}, squared_distance};
}

size_t greenloop_vertex_count(const greenloop_model* model) { return model_in(model).view().vertices.size(); }

int greenloop_vertex_on_surface(const greenloop_model* model, size_t vertex, greenloop_vertex* where) {
  const std::span<const layout::VertexRecord> vertices = model_in(model).view().vertices;
  if (vertex >= vertices.size()) return 0;
  std::memcpy(where, &vertices[vertex], sizeof *where);
  return 1;
}

const char* greenloop_surface_error_text(greenloop_surface_error error) {
  const auto index = static_cast<std::size_t>(error);
  return index < sizeof error_texts / sizeof *error_texts ? error_texts[index] : "unknown";
}
