#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/store/green_store.hpp"
#include "offline/pipeline/body_geometry.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {

/// Part of every fingerprint: raised when a stage starts to give other results for the same scene.
inline constexpr std::string_view pipeline_version = "pipeline 4";

/// The whole file. Throws std::runtime_error if it cannot be opened.
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// All files that the scene's mesh consists of, one behind the other with a zero between. Throws MeshFileError if one
/// of them cannot be read.
[[nodiscard]] std::string mesh_bytes(const Scene& scene);

/// Of what the exact columns of a scene over the bytes of its mesh follow from: see body_text.
[[nodiscard]] std::string column_fingerprint(const Scene& scene, const std::string& mesh);

/// Domain nodes, each of which is a row and a column.
[[nodiscard]] std::size_t domain_size(const BodyGeometry& body);

/// All that is needed to solve the body, filled with tetrahedra unless the scene brought its own. Provenance is what
/// came out of each stage.
[[nodiscard]] GreenStoreContents describe_problem(const Scene& scene, BodyGeometry body, const std::string& fingerprint,
                                                  ProgressBar& progress);

}  // namespace greenloop::offline
