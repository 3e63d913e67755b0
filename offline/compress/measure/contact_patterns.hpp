#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/layout.hpp"
#include "offline/compress/measure/touched_surface.hpp"

namespace greenloop::offline {

/// A rigid ball in space.
struct RigidSphere {
  Eigen::Vector3d centre;  ///< m
  double radius = 0;       ///< m

  /// Where a point is pushed to: radially onto the surface.
  [[nodiscard]] Eigen::Vector3d displacement(const Eigen::Vector3d& point) const {
    return centre + radius * (point - centre).normalized() - point;
  }
};

/// Nodes that touch at one place, and the displacements that they are given there.
struct ContactSite {
  std::uint32_t contacts = 0;              ///< asked for: 1, 4, 16, 64 or the scene's
  std::vector<std::size_t> rows;           ///< domain rows, distinct, all touchable
  std::vector<std::uint32_t> group;        ///< by contact: 0, or 1 for those of the second finger
  std::vector<layout::PatternKind> kinds;  ///< by sample
  Eigen::MatrixXd displacement;            ///< 3 rows.size() x samples, m; no column is zero
  std::optional<RigidSphere> sphere;       ///< it keeps only those of the contacts that it pushes
};

/// Contacts that people make, for one to `max_contacts` contacts (1, 4, 16, 64 and, up to
/// layout::most_pattern_contacts, max_contacts itself), as far as the surface has as many points: layout::PatternKind
/// says which. At most `sites` places of each kind and number, fewer where patches would cover the surface more than
/// four times, spread as far from each other as can be; those of a pinch are the thinnest third of up to 512 places
/// that the inward normal was shot through. A body without opposite sides has no pinches, one without distant places
/// nothing opposed. Deterministic, the same on every machine. Work: some passes over the points for each site, 512 over
/// the triangles. Offline only.
[[nodiscard]] std::vector<ContactSite> contact_patterns(const TouchedSurface& surface, std::uint32_t max_contacts,
                                                        std::size_t sites);

/// The numbers of contacts that patterns have on a surface of `points` points, increasing.
[[nodiscard]] std::vector<std::uint32_t> pattern_sizes(std::uint32_t max_contacts, std::size_t points);

}  // namespace greenloop::offline
