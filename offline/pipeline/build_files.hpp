#pragma once

#include "offline/pipeline/build_model_file.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {

/// Throws std::runtime_error, naming files and remedy, if model, record and store of the build cannot all be written,
/// are each other or what is read, or if a file stands where the record goes that is none. `request.store` is set.
void require_build_files(const BuildRequest& request, const Scene& scene);

/// Whether the model is written through to a device or a pipe: it has no record then and is never up to date.
[[nodiscard]] bool is_passed_on(const BuildRequest& request);

}  // namespace greenloop::offline
