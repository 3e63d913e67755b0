#pragma once

#include <cstddef>

#include "offline/compress/model_builder.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// Domain nodes of the coarsest level that wavelets are compared on.
inline constexpr std::size_t least_comparison_rows = 400;

/// build_model with the wavelet, of all layout::wavelets, that serves the body best: each is tried on the body
/// sampled on the coarsest mesh level of at least `least_rows` domain nodes, or of the body itself if it has no such
/// coarser level, at the accuracy asked for; input.wavelet does not matter. The smallest file wins; if facts.step_work
/// says that there is a budget of work, the smallest product of bytes and step_work. The comparison is in the report;
/// there is none for a mesh of one level. Work: besides build_model, five times the same for 400 to 1,600 nodes.
/// Throws as build_model does. Offline only.
[[nodiscard]] BuiltModel build_with_best_wavelet(CompressionInput input, const Progress& progress,
                                                 std::size_t least_rows = least_comparison_rows);

}  // namespace greenloop::offline
