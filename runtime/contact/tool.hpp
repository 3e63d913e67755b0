#pragma once

#include <cstdint>

#include "runtime/contact/polyhedron.hpp"
#include "runtime/contact/pose.hpp"

namespace greenloop {

/// The shape of a rigid tool, in its own frame (m). Distances are exact, of all shapes.
class Shape {
 public:
  enum class Kind : std::uint8_t { point, sphere, capsule, box, plane, polyhedron };

  enum class Error : std::uint8_t {
    none,
    bad_size,       ///< a radius, half a side or half a length is not finite, too small or more than 1e6 m
    no_polyhedron,  ///< one that was not created
  };

  /// Points of a tool that are followed against the surface; a capsule's stand along its axis.
  static constexpr std::uint32_t max_axis_points = 8;
  static constexpr std::uint32_t max_points = ConvexPolyhedron::max_vertices;

  /// A point.
  Shape() = default;

  /// Around the origin; radius > 0.
  [[nodiscard]] static Shape sphere(double radius) noexcept;
  /// All that is within `radius` > 0 of the axis from -half_length to half_length >= 0 along z.
  [[nodiscard]] static Shape capsule(double radius, double half_length) noexcept;
  /// Around the origin; half its sides, each > 0.
  [[nodiscard]] static Shape box(const Double3& half) noexcept;
  /// The half space z <= 0.
  [[nodiscard]] static Shape plane() noexcept;
  /// The polyhedron's memory must outlive the shape.
  [[nodiscard]] static Shape polyhedron(const ConvexPolyhedron& polyhedron) noexcept;

  [[nodiscard]] Error check() const noexcept;
  [[nodiscard]] Kind kind() const noexcept { return kind_; }

  /// Of a place (m) in the tool's frame. For the loop; work: distance_work().
  [[nodiscard]] SignedDistance distance(const Double3& place) const noexcept;
  [[nodiscard]] std::uint64_t distance_work() const noexcept;

  /// The point farthest along a direction, in the tool's frame; of several the first. Infinite where a plane goes on
  /// for ever. For the loop; work: a polyhedron's vertices.
  [[nodiscard]] Double3 support(const Double3& direction) const noexcept;

  /// m, of a ball around the origin that holds the shape; infinite of a plane. Work: a polyhedron's vertices.
  [[nodiscard]] double bounding_radius() const noexcept;

  /// Points that are followed against the surface, so that neither a thin part of the body nor one between its nodes is
  /// missed: the point itself, a sphere's centre, points along a capsule's axis at most a radius apart as long as eight
  /// suffice, corners. point: below point_count(), in the tool's frame. Constant work.
  [[nodiscard]] std::uint32_t point_count() const noexcept;
  [[nodiscard]] Double3 point(std::uint32_t i) const noexcept;
  /// m, how far around each of them the shape reaches.
  [[nodiscard]] double point_radius() const noexcept {
    return kind_ == Kind::sphere || kind_ == Kind::capsule ? radius_ : 0;
  }

 private:
  Kind kind_ = Kind::point;
  double radius_ = 0;
  Double3 half_;  ///< of a capsule that of its length, along z
  ConvexPolyhedron polyhedron_;
};

/// A tool in one step.
struct Tool {
  Shape shape;
  Pose pose;
};

/// Why a tool was left alone in a step.
enum class ToolFault : std::uint8_t {
  none,
  bad_shape,        ///< Shape::check
  too_many_points,  ///< more than the limits have
  not_finite,       ///< its pose, see PoseError
  too_far,
  not_unit,
};

}  // namespace greenloop
