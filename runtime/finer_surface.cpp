#include "runtime/finer_surface.hpp"

#include <cmath>
#include <new>

#include "runtime/algebra/double3.hpp"
#include "runtime/display/parts.hpp"
#include "runtime/memory/fit.hpp"
#include "runtime/surface/parts.hpp"

namespace greenloop {
namespace {

Vec4 sum_of(const Vec4& a, const Vec4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, 0}; }
Vec4 weighted(float a, const Vec4& x, float b, const Vec4& y) {
  return {a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z, 0};
}

bool in_range(const FinerSurface::Options& options) {
  return options.added <= FinerSurface::most_added &&
         (options.rule == FinerSurface::Rule::midpoint || options.rule == FinerSurface::Rule::loop);
}

FinerSurfaceParts* carve(Arena& arena, FinerSurfaceParts& parts) {
  auto* const place = arena.take<FinerSurfaceParts>(1);
  parts.carve(arena);
  return place;
}

void place_nodes(const FinerSurfaceParts& parts, std::span<const Vec4> displacement, Vec4* position) {
  const layout::NodeRecord* const nodes = parts.surface.parts().nodes;
  for (std::uint32_t i = 0; i < parts.vertex_count[0]; ++i) {
    const float* const x = nodes[i].position;
    const Vec4 u = displacement.empty() ? Vec4{} : displacement[i];
    position[i] = {x[0] + u.x, x[1] + u.y, x[2] + u.z, 0};
  }
}

// The positions of level k from those of the one before, in place.
void halve_edges(const FinerSurfaceParts& parts, std::uint32_t k, Vec4* position) {
  for (std::uint32_t v = parts.vertex_count[k - 1]; v < parts.vertex_count[k]; ++v) {
    const HalvedEdge& edge = parts.halved[v - parts.vertex_count[0]];
    position[v] = weighted(0.5F, position[edge.end[0]], 0.5F, position[edge.end[1]]);
  }
}

void apply_loop(const FinerSurfaceParts& parts, std::uint32_t k, Vec4* position) {
  const std::uint32_t first = parts.vertex_count[k - 1];
  for (std::uint32_t v = 0; v < first; ++v) parts.sum[v] = {};
  for (std::uint32_t v = first; v < parts.vertex_count[k]; ++v) {
    const auto& [end, wing] = parts.halved[v - parts.vertex_count[0]];
    const auto [a, b] = end;
    parts.sum[a] = sum_of(parts.sum[a], position[b]);
    parts.sum[b] = sum_of(parts.sum[b], position[a]);
    position[v] =
        weighted(0.375F, sum_of(position[a], position[b]), 0.125F, sum_of(position[wing[0]], position[wing[1]]));
  }
  constexpr LoopWeight regular{0.625F, 0.0625F};  // of six neighbours
  for (std::uint32_t v = 0; v < first; ++v) {
    const LoopWeight& weight = v < parts.vertex_count[0] ? parts.weight[v] : regular;
    position[v] = weighted(weight.own, position[v], weight.neighbour, parts.sum[v]);
  }
}

Double3 exact(const Vec4& v) { return {v.x, v.y, v.z}; }

}  // namespace

std::size_t FinerSurface::required(const Surface& surface, const Options& options) noexcept {
  FinerSurfaceParts parts;
  if (!in_range(options) || !parts.count(surface, options)) return 0;
  Arena counting;
  static_cast<void>(carve(counting, parts));
  return counting.bytes() <= SIZE_MAX ? static_cast<std::size_t>(counting.bytes()) : 0;
}

FinerSurface::Created FinerSurface::create(const Surface& surface, const Options& options,
                                           std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  created.requested = required(surface, options);
  if (created.requested == 0) {
    created.error = in_range(options) ? Error::unsupported_surface : Error::bad_options;
    return created;
  }
  if (!memory_fits(memory, Error::memory_too_small, Error::memory_misaligned, created)) return created;
  FinerSurfaceParts counted;
  static_cast<void>(counted.count(surface, options));
  Arena arena(memory.data());
  auto* const parts = new (carve(arena, counted)) FinerSurfaceParts(counted);
  static_cast<void>(surface.triangles(surface.level(), {parts->triangle, parts->triangle_count[0]}));
  for (std::uint32_t k = 0; k < options.added; ++k) {
    if (!parts->split(k)) {
      created.error = Error::unsupported_surface;
      return created;
    }
    if (k == 0) parts->weigh();
  }
  created.surface.parts_ = parts;
  return created;
}

std::uint32_t FinerSurface::added() const noexcept { return parts_->options.added; }

std::uint32_t FinerSurface::vertex_count(std::uint32_t k) const noexcept {
  return k <= added() ? parts_->vertex_count[k] : 0;
}

std::uint32_t FinerSurface::triangle_count(std::uint32_t k) const noexcept {
  return k <= added() ? parts_->triangle_count[k] : 0;
}

Surface::Triangle FinerSurface::triangle(std::uint32_t k, std::uint32_t t) const noexcept {
  return parts_->triangle_at(k, t);
}

const Surface& FinerSurface::surface() const noexcept { return parts_->surface; }

bool FinerSurface::positions(std::uint32_t k, std::span<const Vec4> displacement,
                             std::span<Vec4> position) const noexcept {
  const bool fits = k <= added() && position.size() == vertex_count(k) &&
                    (displacement.empty() || displacement.size() >= vertex_count(0));
  if (!fits) return false;
  place_nodes(*parts_, displacement, position.data());
  for (std::uint32_t level = 1; level <= k; ++level) {
    if (parts_->options.rule == Rule::loop) {
      apply_loop(*parts_, level, position.data());
    } else {
      halve_edges(*parts_, level, position.data());
    }
  }
  return true;
}

bool FinerSurface::normals(std::uint32_t k, std::span<const Vec4> position, std::span<Vec4> normal) const noexcept {
  if (k > added() || position.size() != vertex_count(k) || normal.size() != position.size()) return false;
  for (Vec4& one : normal) one = {};
  for (std::uint32_t t = 0; t < triangle_count(k); ++t) {
    const auto [a, b, c] = triangle(k, t).node;
    const Double3 from = exact(position[a]);
    const Double3 area = cross(exact(position[b]) - from, exact(position[c]) - from);
    const Vec4 narrow{static_cast<float>(area.x), static_cast<float>(area.y), static_cast<float>(area.z), 0};
    for (const std::uint32_t vertex : {a, b, c}) normal[vertex] = sum_of(normal[vertex], narrow);
  }
  for (Vec4& one : normal) {
    const Double3 way = unit(exact(one));
    one = {static_cast<float>(way.x), static_cast<float>(way.y), static_cast<float>(way.z), 0};
  }
  return true;
}

}  // namespace greenloop
