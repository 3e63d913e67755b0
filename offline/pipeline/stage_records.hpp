#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "formats/store/green_store.hpp"
#include "offline/compress/model_builder.hpp"
#include "offline/pipeline/body_geometry.hpp"
#include "offline/sources/fem/green_functions.hpp"
#include "offline/sources/fem/mesh_error.hpp"

namespace greenloop::offline {

// What came out of the stages, as JSON for the provenance of stores and models and for build records. Nothing is
// computed from it.

[[nodiscard]] nlohmann::json geometry_record(const GeometryReport& report);
[[nodiscard]] nlohmann::json volume_record(const FilledVolume& filled);
[[nodiscard]] nlohmann::json solve_record(const SolveReport& report, const GreenStore& store);

[[nodiscard]] nlohmann::json mesh_error_record(const MeshError& error);

/// What was tried, from fewer bytes to more, with the figures of every constraint level; those of trials that were not
/// chosen are measured on a sample of patches and columns.
[[nodiscard]] nlohmann::json frontier_record(const CompressionReport& report);

/// What each wavelet would have cost, if they were compared.
[[nodiscard]] nlohmann::json wavelets_record(const CompressionReport& report);

/// `contacts` at once: what work in the frontier is for.
[[nodiscard]] nlohmann::json compression_record(const CompressionReport& report, std::uint32_t contacts);

}  // namespace greenloop::offline
