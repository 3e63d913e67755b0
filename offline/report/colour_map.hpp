#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace greenloop::offline {

/// sRGB components in 0..1.
using Colour = Eigen::Vector3f;

/// The colour of `value` in 0..1 (clamped): from light grey, for what does not move, over yellow and red to dark
/// violet. Lightness falls steadily, so the order survives any colour vision and a black-and-white print.
[[nodiscard]] Colour displacement_colour(float value);

/// `count` >= 2 colours evenly spaced over the map, "#rrggbb".
[[nodiscard]] std::vector<std::string> displacement_gradient(int count);

/// Relative luminance (WCAG 2.1) of an sRGB colour, 0..1.
[[nodiscard]] float luminance(const Colour& colour);

}  // namespace greenloop::offline
