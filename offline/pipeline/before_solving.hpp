#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>

#include "formats/store/green_store.hpp"
#include "offline/pipeline/body_geometry.hpp"
#include "offline/pipeline/build_model_file.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {

/// Says what a body without tetrahedra or columns will take, and refuses what can be foreseen: a budget that no model
/// of it could keep, nodes that the author's tetrahedra cannot carry, a store or memory above most_bytes_unasked that
/// was not asked for, a disk without room. Throws SceneError or std::runtime_error that name the file, the numbers and
/// how many levels would do.
void require_buildable(const BuildRequest& request, const Scene& scene, const BodyGeometry& body,
                       ProgressBar& progress);

/// The same where the store stands, of what is missing in it.
void require_buildable(const BuildRequest& request, const Scene& scene, const GreenStore& store, ProgressBar& progress);

/// Says how many tetrahedra are across the thinnest part, and warns of fewer than three.
/// Returns {tetrahedra_across, metres, at}.
[[nodiscard]] nlohmann::json say_thickness(const Scene& scene, const GreenStoreContents& contents,
                                           ProgressBar& progress);

/// What the record says of the sizes of a body with tetrahedra.
[[nodiscard]] nlohmann::json sizes_record(const GreenStoreContents& contents);

}  // namespace greenloop::offline
