#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/algebra/double3.hpp"
#include "sim_hw/body/body_surface.hpp"

namespace greenloop {

/// A place of the body that a sphere reaches first when it comes straight from outside.
struct TouchPlace {
  Double3 centre;          ///< m, of the sphere when it just touches
  Double3 outward;         ///< unit vector, back to where the sphere came from
  std::uint32_t node = 0;  ///< the node it touches
  double facing = 0;       ///< cosine between the node's normal and `outward`
};

/// Lowers a sphere of `radius` m against `outward` along the line through `point` until it touches a node. None if it
/// passes the body, or meets a node that cannot be touched or faces away (facing < `least_facing`).
[[nodiscard]] std::optional<TouchPlace> lower_sphere(const BodySurface& surface, double radius, const Double3& point,
                                                     const Double3& outward, double least_facing = 0.3);

/// Up to `most` places far from each other, in a fixed order. Throws std::runtime_error if there is none.
[[nodiscard]] std::vector<TouchPlace> touch_places(const BodySurface& surface, double radius, std::size_t most);

/// Two places to hold the body between: reached along one line from both sides where the shape allows, else the two
/// most opposite ones. None if there are no two places.
[[nodiscard]] std::optional<std::array<TouchPlace, 2>> opposing_places(const BodySurface& surface, double radius);

/// The longest row of places next to each other, at most `length` m to either side of one of `starts`.
[[nodiscard]] std::vector<TouchPlace> sliding_row(const BodySurface& surface, double radius, double length,
                                                  const std::vector<TouchPlace>& starts);

}  // namespace greenloop
