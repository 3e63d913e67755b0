#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/surface/surface_report.hpp"

namespace greenloop::offline {

/// A surface that does not enclose one solid. what() lists every defect with its place and how to mend it;
/// faces are numbered as in the file (after the repairs it mentions, if any).
class SurfaceError : public std::runtime_error {
 public:
  SurfaceError(std::vector<std::string> defects, const std::vector<std::string>& repairs, SurfaceReport report);

  [[nodiscard]] const std::vector<std::string>& defects() const { return defects_; }
  [[nodiscard]] const SurfaceReport& report() const { return report_; }

 private:
  std::vector<std::string> defects_;
  SurfaceReport report_;
};

struct PreparedSurface {
  TriangleMesh mesh;                   ///< the skin of one solid, outward oriented, every vertex in use
  std::vector<std::string> repairs;    ///< what was changed, one sentence each; empty if nothing
  SurfaceReport report;                ///< of `mesh`
  std::vector<TriangleMesh> cavities;  ///< in it, if they are kept: each outward oriented by itself
};

/// Welding by distance: nothing for "as far as it takes", else vertices within this of another become one with it, in
/// the mesh's unit; 0 welds none by distance.
using Weld = std::optional<double>;

/// What to do with closed pieces inside the largest one.
enum class Inside { refused, cavities };

/// Makes the surface usable where that cannot change its shape, and says what it did:
/// vertices in no face are dropped; faces that occur twice are dropped and vertices at exactly the same position merged
/// if that leaves a closed manifold surface; if it does not and `weld` is nothing, vertices on the boundary that are
/// within 1e-12, 1e-9, 1e-7, 1e-6 or 1e-5 of the bounding box's diagonal are merged, the shortest of these that leaves
/// a closed manifold surface and collapses no face (but by 1e-12, which is rounding); faces are turned to one
/// consistent outward orientation, or, if `inside` says that they are cavities, each piece by itself. A `weld` above 0
/// is done first, to all vertices, and faces that it collapses are dropped. Everything else is an error. Throws
/// SurfaceError naming each remaining defect. Work: that of check_surface.
[[nodiscard]] PreparedSurface prepare_surface(const TriangleMesh& mesh, Weld weld = std::nullopt,
                                              Inside inside = Inside::refused);

}  // namespace greenloop::offline
