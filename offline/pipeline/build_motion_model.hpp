#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "offline/pipeline/progress_bar.hpp"
#include "offline/scene/motion_scene.hpp"

namespace greenloop::offline {

/// From trajectories to a verified impulse response model at `model`, always anew, and its record beside it
/// (MODEL.build.json). Returns the record. `scene_file` is for messages and the record. Throws std::runtime_error
/// saying what to mend.
nlohmann::json build_motion_model(const std::filesystem::path& scene_file, const MotionScene& scene,
                                  const std::filesystem::path& model, ProgressBar& progress);

}  // namespace greenloop::offline
