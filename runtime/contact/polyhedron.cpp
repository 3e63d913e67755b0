#include "runtime/contact/polyhedron.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/memory/arena.hpp"
#include "runtime/memory/fit.hpp"
#include "runtime/surface/closest_point.hpp"

namespace greenloop {
namespace {

using Error = ConvexPolyhedron::Error;
using Face = ConvexPolyhedron::Face;

struct Fault {
  Error error = Error::none;
  std::uint32_t at = 0;
};

constexpr double farthest = 1e6;
constexpr double coincident = 1e-12;  // m: where the direction to a point is lost in rounding

bool is_near(double coordinate) { return std::abs(coordinate) <= farthest; }

bool has_edge(const Face& face, std::uint32_t from, std::uint32_t to) {
  const auto& [a, b, c] = face.vertex;
  return (a == from && b == to) || (b == from && c == to) || (c == from && a == to);
}

std::uint32_t count_edges(std::span<const Face> face, std::uint32_t from, std::uint32_t to) {
  std::uint32_t count = 0;
  for (const Face& f : face) count += has_edge(f, from, to) ? 1 : 0;
  return count;
}

Double3 twice_area(std::span<const Double3> vertex, const Face& face) {
  const Double3 a = vertex[face.vertex[0]];
  return cross(vertex[face.vertex[1]] - a, vertex[face.vertex[2]] - a);
}

Fault check_numbers(std::span<const Double3> vertex, std::span<const Face> face) {
  for (std::uint32_t i = 0; i < vertex.size(); ++i) {
    if (!is_near(vertex[i].x) || !is_near(vertex[i].y) || !is_near(vertex[i].z)) return {Error::not_finite, i};
  }
  for (std::uint32_t f = 0; f < face.size(); ++f) {
    for (const std::uint32_t v : face[f].vertex) {
      if (v >= vertex.size()) return {Error::bad_index, f};
    }
    if (!(norm(twice_area(vertex, face[f])) > 0)) return {Error::flat_face, f};
  }
  return {};
}

Fault check_closed(std::span<const Face> face) {
  for (std::uint32_t f = 0; f < face.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = face[f].vertex[k], to = face[f].vertex[(k + 1) % 3];
      if (count_edges(face, from, to) != 1 || count_edges(face, to, from) != 1) return {Error::not_closed, f};
    }
  }
  return {};
}

// the volume is six times the sum of determinants, about a vertex so that a far body loses no digits
Fault check_outward(std::span<const Double3> vertex, std::span<const Face> face) {
  double volume = 0;
  for (const Face& f : face) volume += dot(vertex[f.vertex[0]] - vertex[0], twice_area(vertex, f));
  return {volume > 0 ? Error::none : Error::inward, 0};
}

Fault check(std::span<const Double3> vertex, std::span<const Face> face) {
  if (vertex.size() < 4 || vertex.size() > ConvexPolyhedron::max_vertices || face.size() < 4 ||
      face.size() > ConvexPolyhedron::max_faces) {
    return {Error::bad_count, 0};
  }
  Fault fault = check_numbers(vertex, face);
  if (fault.error == Error::none) fault = check_closed(face);
  if (fault.error == Error::none) fault = check_outward(vertex, face);
  return fault;
}

}  // namespace

void ConvexPolyhedron::carve(Arena& arena, std::size_t vertices, std::size_t faces) noexcept {
  vertices_ = static_cast<std::uint32_t>(vertices);
  faces_ = static_cast<std::uint32_t>(faces);
  vertex_ = arena.take<Double3>(vertices);
  face_ = arena.take<Face>(faces);
  plane_ = arena.take<Plane>(faces);
}

std::size_t ConvexPolyhedron::required(std::size_t vertices, std::size_t faces) noexcept {
  if (vertices > max_vertices || faces > max_faces) return 0;
  Arena arena;
  ConvexPolyhedron counted;
  counted.carve(arena, vertices, faces);
  return static_cast<std::size_t>(arena.bytes());
}

double ConvexPolyhedron::size() const noexcept {
  double largest = 0;
  for (const Double3& v : vertices()) {
    const Double3 offset = v - vertex_[0];
    largest = std::max({largest, std::abs(offset.x), std::abs(offset.y), std::abs(offset.z)});
  }
  return largest;
}

ConvexPolyhedron::Created ConvexPolyhedron::create(std::span<const Double3> vertex, std::span<const Face> face,
                                                   std::span<std::byte> memory) noexcept {
  Created created;
  const Fault fault = check(vertex, face);
  created.error = fault.error;
  created.at = fault.at;
  created.available = memory.size();
  if (!created) return created;
  created.requested = required(vertex.size(), face.size());
  if (!memory_fits(memory, Error::memory_too_small, Error::memory_misaligned, created)) return created;
  ConvexPolyhedron& made = created.polyhedron;
  Arena arena(memory.data());
  made.carve(arena, vertex.size(), face.size());
  std::copy(vertex.begin(), vertex.end(), made.vertex_);
  std::copy(face.begin(), face.end(), made.face_);
  const double standing_out = flatness * made.size();
  for (std::uint32_t f = 0; f < made.faces_; ++f) {
    Plane& plane = made.plane_[f];
    plane.normal = unit(twice_area(vertex, face[f]));
    plane.offset = dot(plane.normal, vertex[face[f].vertex[0]]);
    for (const Double3& v : vertex) {
      if (dot(plane.normal, v) - plane.offset > standing_out) {
        created.error = Error::not_convex;
        created.at = f;
        return created;
      }
    }
  }
  return created;
}

SignedDistance ConvexPolyhedron::distance(const Double3& place) const noexcept {
  double farthest_out = -HUGE_VAL;
  std::uint32_t facing = 0;
  for (std::uint32_t f = 0; f < faces_; ++f) {
    const double height = dot(plane_[f].normal, place) - plane_[f].offset;
    if (height > farthest_out) {
      farthest_out = height;
      facing = f;
    }
  }
  if (!(farthest_out > 0)) return {farthest_out, plane_[facing].normal};
  return from_outside(place, facing);
}

// the nearest point lies on a face that sees the place; none is nearer than its plane
SignedDistance ConvexPolyhedron::from_outside(const Double3& place, std::uint32_t facing) const noexcept {
  SignedDistance nearest{HUGE_VAL, plane_[facing].normal};
  const auto look = [&](std::uint32_t f) {
    const double height = dot(plane_[f].normal, place) - plane_[f].offset;
    if (!(height > 0) || !(height < nearest.distance)) return;
    const auto& [a, b, c] = face_[f].vertex;
    const ClosestPoint closest = closest_to_origin({vertex_[a] - place, vertex_[b] - place, vertex_[c] - place});
    const double distance = std::sqrt(closest.squared_distance);
    if (!(distance < nearest.distance)) return;
    const double* w = closest.weight;
    const bool is_foot = w[0] > 0 && w[1] > 0 && w[2] > 0;
    const Double3 way = place - (w[0] * vertex_[a] + w[1] * vertex_[b] + w[2] * vertex_[c]);
    nearest.distance = is_foot ? height : distance;
    nearest.normal = is_foot || distance < coincident ? plane_[f].normal : unit(way);
  };
  look(facing);
  for (std::uint32_t f = 0; f < faces_; ++f) look(f);
  return nearest;
}

}  // namespace greenloop
