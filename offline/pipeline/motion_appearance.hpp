#pragma once

#include <nlohmann/json.hpp>

#include "formats/write/impulse_response.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/scene/motion_scene.hpp"

namespace greenloop::offline {

/// Computes what a scene says of its appearance and puts it into the model; returns what it cost, for the record. Warns
/// if the error that was asked for is not reached. Throws what appearance_of throws. Work: that of appearance_of.
[[nodiscard]] nlohmann::json add_appearance(const AppearanceScene& scene, ImpulseResponseData& model,
                                            ProgressBar& progress);

}  // namespace greenloop::offline
