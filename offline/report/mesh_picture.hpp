#pragma once

#include <Eigen/Core>
#include <vector>

#include "offline/report/camera.hpp"
#include "offline/report/png_image.hpp"

namespace greenloop::offline {

/// By how much displacements are multiplied for a picture: the largest of 1, 2, 5, 10, ... that keeps the largest
/// displacement within a tenth of the body's size, 1 while it is within three tenths, 0.5, 0.2, ... beyond.
/// `largest` >= 0 and `size` > 0 in the same unit; 1 for a body at rest.
[[nodiscard]] double exaggeration(double largest, double size);

/// A rendered surface and the camera that saw it.
struct Picture {
  Image image;
  Camera camera;  ///< in pixels of the image
};

/// The body displaced by `magnified` (m, as drawn; one per vertex), smoothly shaded and coloured by `value` (0..1 per
/// vertex, colour_map.hpp), the outline of the body at rest over it, dots on the fixed vertices, transparent around.
/// `longest` side in pixels. Work: the picture's area plus choose_view's, if that made `frame`.
[[nodiscard]] Picture deformed_picture(const VisibleSurface& surface, const std::vector<Eigen::Vector3d>& magnified,
                                       const std::vector<float>& value, const ViewFrame& frame, int longest);

/// The body displaced (m; one per vertex) in colours of its vertices (sRGB, 0..1), smooth between them and not shaded,
/// transparent around. `longest` side in pixels. Work: the picture's area.
[[nodiscard]] Picture coloured_picture(const VisibleSurface& surface, const std::vector<Eigen::Vector3d>& displacement,
                                       const std::vector<Eigen::Vector3f>& colour, const ViewFrame& frame, int longest);

/// The surface with its edges, tinted where `touchable` (per vertex) and dotted where fixed, transparent around; framed
/// so that all of `framed_points` fits, so that several levels share one scale.
[[nodiscard]] Picture wire_picture(const VisibleSurface& surface, const std::vector<char>& touchable,
                                   const std::vector<Eigen::Vector3d>& framed_points, const ViewFrame& frame,
                                   int longest);

}  // namespace greenloop::offline
