#pragma once

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
  TriangleMesh mesh;                 ///< the skin of one solid, outward oriented, every vertex in use
  std::vector<std::string> repairs;  ///< what was changed, one sentence each; empty if nothing
  SurfaceReport report;              ///< of `mesh`
};

/// Makes the surface usable where that cannot change its shape, and says what it did:
/// vertices in no face are dropped; faces that occur twice are dropped and vertices at exactly the same position merged
/// if that leaves a closed manifold surface; faces are turned to one consistent outward orientation.
/// Everything else is an error. Throws SurfaceError naming each remaining defect. Work: that of check_surface.
[[nodiscard]] PreparedSurface prepare_surface(const TriangleMesh& mesh);

}  // namespace greenloop::offline
