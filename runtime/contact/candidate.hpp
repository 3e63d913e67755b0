#pragma once

#include <cstdint>

#include "formats/layout.hpp"
#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// A point of the body's surface that may touch a tool in this step, in the frame of the model. If the point moves by u
/// and the tool by v from here on, the gap becomes gap + (u - v) . normal to first order.
struct Candidate {
  /// Nodes whose displacements, times the weights, are the point's: a node alone, or the corners of a triangle. The
  /// weights of corners that are not touchable stand here too.
  std::uint32_t node[3] = {layout::none, layout::none, layout::none};
  double weight[3] = {};                  ///< in 0..1 with sum 1
  std::uint32_t triangle = layout::none;  ///< none: it is a node alone
  std::uint32_t tool = 0;                 ///< by its place among the tools
  std::uint32_t feature = layout::none;   ///< the point of the tool (Shape::point) that comes near; none: its surface;
                                          ///< from Shape::max_points on: a triangle beside the nearest place of a point
  double gap = 0;                         ///< m, along the normal; negative where the point is inside the tool
  double depth = 0;                       ///< m, how deep it would be inside but for its force of the last step
  Double3 normal;                         ///< unit, out of the tool, on the side that the body was on
  Double3 position;                       ///< m, of the point of the body, displaced
};

}  // namespace greenloop
