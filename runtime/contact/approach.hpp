#pragma once

#include "runtime/contact/tool.hpp"

namespace greenloop {

/// How a place of the body lies to a tool after both have moved a step, in the model's frame.
struct Approach {
  double gap = 0;  ///< m, along the normal; negative: how far back the place has to go
  Double3 normal;  ///< unit, out of the tool: where the tool pushes
};

/// Follows a place of the body from the tool's last placement to the present one, in the tool's frame and straight.
/// Where it has come to is measured from the plane of the tool's surface through which it entered; a place that passed
/// through, and is beyond the tool, too. One that enters nothing, or only cuts a corner, has the tool's distance and
/// normal. The way in is found by steps of the distance, at most most_advances of them (Hart 1996): where these do not
/// suffice, the plane is that of the tool's point nearest to where they end, which bounds the tool as well. For the
/// loop; work: of the steps that were made, which is added to `work`, at most approach_work().
[[nodiscard]] Approach approach(const Shape& shape, const Placement& last, const Placement& present,
                                const Double3& place, std::uint64_t& work) noexcept;

inline constexpr int most_advances = 16;
[[nodiscard]] inline std::uint64_t approach_work(const Shape& shape, std::uint64_t advances = most_advances) noexcept {
  constexpr std::uint64_t transforms = 120, advance = 30;
  return transforms + (advances + 2) * (advance + shape.distance_work());
}

}  // namespace greenloop
