#pragma once

#include <optional>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/remesh/remesh.hpp"
#include "offline/scene/scene.hpp"
#include "offline/surface/surface_preparation.hpp"
#include "offline/wrap/wrap.hpp"

namespace greenloop::offline {

/// A wrap whose length is chosen is rounded until a base of so many times the size asked for will do.
inline constexpr int most_growth_of_wraps = 2;

/// A closed surface and what was made of it; m.
struct RemeshedSkin {
  PreparedSurface surface;
  std::optional<WrapReport> wrap;
  Remeshed remeshed;
  TriangleMesh walls;  ///< of the surface's cavities, evenly meshed, looking into them
};

/// Remeshes a surface as the scene asks for, and the walls of its cavities to edges as long as its own. Throws as
/// remesh and even_surface do.
[[nodiscard]] RemeshedSkin remesh_skin(const Scene& scene, PreparedSurface surface, ProgressBar& progress);

/// Wraps any faces [m], of whose reading `notes` tells, and remeshes that. A wrap of a given length is remeshed as it
/// is. Of one whose length is chosen, a form that the levels asked for resolve is found: while no base of at most twice
/// the size asked for will do, it is wrapped again, rounded by one, two, four edges of a finest triangle (see
/// round_solid); why is told among the repairs. The work is that of four wraps, and of four times six attempts to
/// remesh at most. Throws as wrap, prepare_surface and remesh do.
[[nodiscard]] RemeshedSkin wrap_and_remesh(const Scene& scene, const TriangleMesh& faces, const MeshNotes& notes,
                                           ProgressBar& progress);

}  // namespace greenloop::offline
