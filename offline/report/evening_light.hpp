#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "offline/report/camera.hpp"
#include "runtime/light.hpp"
#include "runtime/vec.hpp"

namespace greenloop::offline {

/// A low, warm sun from the upper left before the picture, and a sky that is brighter above.
[[nodiscard]] Light evening_light(const ViewFrame& frame);

/// Radiances, red, green and blue, as sRGB in 0..1 (IEC 61966-2-1), exposed so that one in a hundred is white.
[[nodiscard]] std::vector<Eigen::Vector3f> displayed(std::span<const Vec3> radiance);

}  // namespace greenloop::offline
