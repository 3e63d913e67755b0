#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "offline/pipeline/progress_bar.hpp"
#include "offline/scene/scene.hpp"
#include "offline/simulate/elastic_solid.hpp"
#include "offline/simulate/thin_sheets.hpp"

namespace greenloop::offline {

struct SimulateRequest {
  std::filesystem::path scene;  ///< scene.toml
  std::filesystem::path
      trajectories;        ///< HDF5, to write or to go on with; empty: as the scene says. States go beside it
  bool overwrite = false;  ///< begin again
};

/// The body of a scene that has a [simulate] section: tetrahedra in the surface of the level that it names, and the
/// finest level shown. Throws as make_body_geometry and tetrahedralize do.
[[nodiscard]] ElasticSolidScene make_elastic_solid(const Scene& scene, ProgressBar& progress);

/// The sheets of a scene that has [simulate] and [sheet] sections. Throws MeshFileError.
[[nodiscard]] SheetScene make_sheet_scene(const Scene& scene);

/// Plays the orbits that a scene asks for into a trajectory file; goes on where a killed run stopped. The record says
/// what was played. Throws SceneError, or std::runtime_error saying what to mend; whole orbits stay in the file.
nlohmann::json simulate_scene(SimulateRequest request, ProgressBar& progress);

}  // namespace greenloop::offline
