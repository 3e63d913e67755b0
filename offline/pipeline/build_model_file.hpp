#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "offline/pipeline/progress_bar.hpp"

namespace greenloop::offline {

struct BuildRequest {
  std::filesystem::path scene;   ///< scene.toml
  std::filesystem::path model;   ///< .gloop to write; its record goes beside it as .build.json
  std::filesystem::path store;   ///< exact Green's functions, HDF5; resumed if it is the scene's. Empty: as the scene
                                 ///< says, else beside the model
  bool overwrite_store = false;  ///< replace a store of another scene that holds columns
  bool allow_large = false;      ///< even if store or memory take more than most_bytes_unasked
  bool force = false;            ///< build even if the model is up to date
};

/// What a build came to.
struct BuildOutcome {
  bool up_to_date = false;                 ///< nothing was built
  std::size_t bytes = 0, dense_bytes = 0;  ///< of the model and of its dense matrix, if it was built
  nlohmann::json record;                   ///< for people; `up_to_date` says there, too, that it is an older one
};

/// Where the record of a model's build stands: model.gloop -> model.build.json.
[[nodiscard]] std::filesystem::path build_record_path(const std::filesystem::path& model);

/// From a scene to a verified model file: surface, remesh, solve, compress, write. Columns already in the store are
/// kept, a model that is up to date is left alone. The record is also written to build_record_path. Throws SceneError
/// or std::runtime_error saying what to mend; what was computed until then stays in the store.
BuildOutcome build_model_file(const BuildRequest& asked, ProgressBar& progress);

}  // namespace greenloop::offline
