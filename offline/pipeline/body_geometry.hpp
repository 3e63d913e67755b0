#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/remesh/quality.hpp"
#include "offline/scene/scene.hpp"
#include "offline/surface/surface_report.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/tetrahedralize.hpp"
#include "offline/wrap/wrap.hpp"

namespace greenloop::offline {

/// The tetrahedra that carry a surface.
struct Volume {
  TetrahedralMesh mesh;             ///< m
  std::vector<std::uint8_t> fixed;  ///< per vertex, nonzero = fixed
  Interpolation interpolation;      ///< surface displacement from the vertices'
};

/// What came out on the way to a body's surface, for people.
struct GeometryReport {
  std::string file;                  ///< of the mesh, as the scene names it
  SurfaceReport surface;             ///< what was remeshed
  std::vector<std::string> repairs;  ///< of the mesh, and what its reader passed over, one sentence each
  std::optional<WrapReport> wrap;    ///< if the scene asks for one; m
  std::size_t cavities = 0;          ///< in the surface
  double cavity_volume = 0;          ///< m^3
  RemeshQuality remesh;
};

/// The body a scene describes, before anything is solved: its semi-regular surface in the model file's node order.
struct BodyGeometry {
  SemiRegularMesh surface;           ///< m
  std::vector<std::uint32_t> flags;  ///< layout::NodeFlag per node, domain marked
  std::vector<double> area;          ///< m^2 per node, its hat function's integral
  TriangleMesh walls;                ///< of cavities, looking into them; m. `volume` has them already
  std::optional<Volume> volume;      ///< the user's own, if the scene names one
  GeometryReport report;
};

/// Reads, checks, scales and remeshes what the scene names, finds the scene's node sets and orders the nodes.
/// Throws SceneError or std::runtime_error that name what is wrong and how to mend it.
[[nodiscard]] BodyGeometry make_body_geometry(const Scene& scene, ProgressBar& progress);

/// A volume that a program made, and what it is worth.
struct FilledVolume {
  Volume volume;
  std::string mesher;
  TetrahedraQuality quality;
};

/// Tetrahedra between a level of the surface, whose vertices come first, and the walls, made by tetrahedralize. Throws
/// as that does, and std::runtime_error where walls and surface come too close for their triangles.
[[nodiscard]] Tetrahedralization tetrahedra_within(const BodyGeometry& body, int level);

/// Tetrahedra inside the finest level.
[[nodiscard]] FilledVolume fill_with_tetrahedra(const BodyGeometry& body, ProgressBar& progress);

}  // namespace greenloop::offline
