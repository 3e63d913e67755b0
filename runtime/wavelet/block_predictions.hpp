#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"

namespace greenloop {

/// Predicts the domain nodes of a level with weights that are blocks, which are read in the file: x_m = the sum of P_mk
/// x_k over the level's terms, those of even number and those of odd number each added up by themselves. sources:
/// [domain nodes * terms] byte offsets of the nodes k in x; details: [domain nodes] of the level, which are moved to
/// its nodes, or null; x: by node; those of coarser levels are read. For the loop; work: node_price per node, in the
/// inverse transform.
template <unsigned N>
using PredictBlocks = void (*)(const LevelView& level, const std::uint32_t* sources, Vector<N>* details,
                               Vector<N>* x) noexcept;

/// On every processor.
template <unsigned N>
void predict_blocks(const LevelView& level, const std::uint32_t* sources, Vector<N>* details, Vector<N>* x) noexcept;

/// The fastest on this processor, of the same bits. Start-up.
template <unsigned N>
[[nodiscard]] PredictBlocks<N> fastest_predict_blocks() noexcept;
template <>
[[nodiscard]] PredictBlocks<1> fastest_predict_blocks<1>() noexcept;
template <>
[[nodiscard]] PredictBlocks<3> fastest_predict_blocks<3>() noexcept;

}  // namespace greenloop
