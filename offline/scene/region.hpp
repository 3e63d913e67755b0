#pragma once

#include <Eigen/Geometry>
#include <span>
#include <variant>
#include <vector>

namespace greenloop::offline {

// Places on a body, in fractions of its bounding box: 0 at the lower end of each axis, 1 at the upper end.

/// Nodes up to (below) or from (above) a fraction of the box along one axis (0 = x, 1 = y, 2 = z).
struct HalfSpace {
  int axis = 0;
  bool below = true;
  double fraction = 0;
};

/// Nodes inside a box.
struct BoxRegion {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

/// Nodes inside a ball; its radius in metres, or in fractions of the bounding box's longest side.
struct SphereRegion {
  Eigen::Vector3d center;
  double radius = 0;
  bool radius_in_metres = false;
};

/// The `count` nodes nearest to a point; of equally near ones those with smaller indices.
struct NearestRegion {
  Eigen::Vector3d point;
  int count = 1;
};

using Region = std::variant<HalfSpace, BoxRegion, SphereRegion, NearestRegion>;

/// One flag per position [m]: is it in the region? Boundaries belong to it. Work: linear (n log n for NearestRegion).
[[nodiscard]] std::vector<bool> evaluate(const Region& region, std::span<const Eigen::Vector3d> positions,
                                         const Eigen::AlignedBox3d& box);

/// Where the linear function of a vertex mask stands, m.
struct MaskSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< the position nearest to the sphere's
  double radius = 0;
};
[[nodiscard]] MaskSphere mask_sphere(const SphereRegion& region, std::span<const Eigen::Vector3d> positions,
                                     const Eigen::AlignedBox3d& box);

/// The linear function of a vertex mask (James & Pai 2001, section 6.1.1) at each position: 1 at the one nearest to the
/// sphere's center, falling to 0 at the radius around that. Work: linear.
[[nodiscard]] std::vector<double> linear_mask(const SphereRegion& region, std::span<const Eigen::Vector3d> positions,
                                              const Eigen::AlignedBox3d& box);

/// The union of several regions; no flag is set if there are none.
[[nodiscard]] std::vector<bool> evaluate(std::span<const Region> regions, std::span<const Eigen::Vector3d> positions,
                                         const Eigen::AlignedBox3d& box);

}  // namespace greenloop::offline
