#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "offline/pipeline/progress_bar.hpp"
#include "offline/scene/multigrid_scene.hpp"

namespace greenloop::offline {

/// From a scene with [multigrid] to a verified multigrid model at `model`, always anew, and its record beside it
/// (MODEL.build.json). Returns the record. `scene_file` is for messages and the record. Throws SceneError and
/// std::runtime_error saying what to mend.
nlohmann::json build_multigrid_model(const std::filesystem::path& scene_file, const MultigridBody& body,
                                     const std::filesystem::path& model, ProgressBar& progress);

}  // namespace greenloop::offline
