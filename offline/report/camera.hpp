#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace greenloop::offline {

/// A surface to look at. Triangles counter-clockwise from outside.
struct VisibleSurface {
  std::vector<Eigen::Vector3d> positions;  ///< m
  std::vector<std::array<int, 3>> triangles;
  std::vector<char> fixed;           ///< per vertex: held in place
  std::vector<char> touchable = {};  ///< per vertex: may be a contact; empty: all alike
};

/// An orthonormal, right-handed frame: to the right, upwards, and out of the picture.
struct ViewFrame {
  Eigen::Vector3d right;
  Eigen::Vector3d up;
  Eigen::Vector3d towards;
};

/// Looks against `towards` (not zero) with `up` as upright as it can be; any other axis stands in if they are parallel.
[[nodiscard]] ViewFrame view_frame(const Eigen::Vector3d& towards, const Eigen::Vector3d& up);

/// Orthographic projection into a picture.
struct Camera {
  ViewFrame frame;
  Eigen::Vector2d low;  ///< right- and up-coordinates of the picture's lower left corner, m
  double scale = 1;     ///< pixels per metre
  int width = 0;        ///< pixels
  int height = 0;

  /// Pixels to the right, pixels down, depth towards the viewer in pixels.
  [[nodiscard]] Eigen::Vector3d project(const Eigen::Vector3d& point) const;
};

/// The camera whose picture, with its longer side `longest` pixels, holds all points and `margin` pixels around them.
[[nodiscard]] Camera fit_camera(const ViewFrame& frame, const std::vector<Eigen::Vector3d>& points, int longest,
                                int margin);

/// The coordinate axis (with sign) that leads from the fixed vertices most clearly to the rest: what is held is below.
/// Without fixed vertices, or when they surround the body, the longest side of the bounding box stands upright.
[[nodiscard]] Eigen::Vector3d upright(const VisibleSurface& surface);

/// The view from the touched side: of a fixed set of directions the one from which most of the squared displacement is
/// unhidden and faces the viewer, then most of the fixed vertices. Without displacement (empty or zero): from which
/// most of what may be touched faces the viewer, and broadly. `displacement` in metres as it is to be drawn. Work:
/// about 120 small z-buffers.
[[nodiscard]] ViewFrame choose_view(const VisibleSurface& surface, const std::vector<Eigen::Vector3d>& displacement);

}  // namespace greenloop::offline
