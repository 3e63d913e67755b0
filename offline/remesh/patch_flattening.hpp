#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace greenloop::offline {

/// One triangle of a flattened patch: which triangle, and the place of each of its corners in the plane.
struct FlatTriangle {
  int triangle = 0;
  std::array<Eigen::Vector2d, 3> corners;
};

/// The same disk triangulated twice over one flat outline: a point of one triangulation is carried to the other
/// through its place in the plane.
struct FlatPatch {
  std::vector<FlatTriangle> before, after;
};

/// A triangle of a patch in space, its corners given as indices into the patch's own vertices.
struct PatchTriangle {
  int triangle = 0;
  std::array<int, 3> corners;
};

/// A patch before and after its two inner vertices become one. Vertices 0 .. outline-1 are its outline,
/// counter-clockwise; vertex outline and outline + 1 are the ends of the collapsed edge, outline + 2 what they become.
struct CollapsePatch {
  std::vector<Eigen::Vector3d> vertices;
  int outline = 0;
  int line = -1;  ///< if the first end lies on a feature line to the second: the outline vertex where that comes from
  std::vector<PatchTriangle> before, after;
};

/// Joint flattening of both triangulations, every triangle of positive area. First choice: the fan of the remaining
/// vertex by the polar map z^a (Lee et al., MAPS, 1998, section 3.2), the two removed ones placed by mean value
/// coordinates. Where that folds a triangle: the outline on a circle, all three by mean value coordinates, which
/// cannot fold (Floater 2003). Nothing is returned if rounding spoils even that.
[[nodiscard]] std::optional<FlatPatch> flatten(const CollapsePatch& patch);

/// The same where the second end stays in its place, so that feature lines through it map to themselves: the first lies
/// on the line from patch.line to it, if there is one, as near to it as folds nothing.
[[nodiscard]] std::optional<FlatPatch> flatten_onto_second(const CollapsePatch& patch);

/// The triangle of `triangulation` that holds `place`, and its barycentric weights there (clamped to >= 0).
struct FlatLocation {
  std::size_t index = 0;
  Eigen::Vector3d weights;
};
[[nodiscard]] FlatLocation locate(const std::vector<FlatTriangle>& triangulation, const Eigen::Vector2d& place);

}  // namespace greenloop::offline
