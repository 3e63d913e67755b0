#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/float4.hpp"

namespace greenloop {

/// Predicts the domain nodes of a level with 3x3 weights, which are read in the file: x_m = the sum of P_mk x_k over
/// the level's terms, those of even number and those of odd number each added up by themselves. sources: [domain nodes
/// * terms] byte offsets of the nodes k in x; x: by node; those of coarser levels are read. For the loop; work:
/// Prediction::node_work units per node, in the inverse transform.
using PredictBlocks = void (*)(const LevelView& level, const std::uint32_t* sources, Float4* x) noexcept;

/// On every processor.
void predict_blocks(const LevelView& level, const std::uint32_t* sources, Float4* x) noexcept;

/// The fastest on this processor, of the same bits. Start-up.
[[nodiscard]] PredictBlocks fastest_predict_blocks() noexcept;

}  // namespace greenloop
