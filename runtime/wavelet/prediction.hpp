#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/stored_block.hpp"
#include "runtime/prices.hpp"

namespace greenloop {

/// How a model predicts an odd node of its mesh; by default from its two parents, with three components.
struct Prediction {
  std::uint32_t components = 3;   ///< of a node
  std::uint32_t length = 2;       ///< nodes that it reads at most
  bool blocks = false;            ///< its weights are blocks, which are read in place, not numbers
  std::uint32_t block_bytes = 0;  ///< of one of those
  bool lifted = false;            ///< and other nodes are lifted into those
};

/// Of a model's wavelets. Work: a unit per level.
[[nodiscard]] Prediction prediction_of(const ModelView& view) noexcept;

// What it costs.

/// Of inverse_transform, an odd node.
constexpr std::uint32_t node_price(const Prices& prices, const Prediction& prediction) {
  if (prediction.blocks) {
    return prices.block_node + prediction.length * prices.block_term;
  }
  return prediction.length > 2 ? prices.butterfly_node : prices.linear_node;
}

/// Of transform_forces, a visit.
constexpr std::uint32_t force_visit_price(const Prices& prices, const Prediction& prediction) {
  return prediction.blocks ? prices.force_visit_by_blocks : prices.force_visit;
}

/// Of T^-1 of two rows of a capacitance matrix, a visit.
constexpr std::uint32_t pair_visit_price(const Prices& prices, const Prediction& prediction) {
  return prediction.blocks ? prices.pair_visit_by_blocks : prices.pair_visit;
}

/// Of a block times a weight of a functional.
constexpr std::uint32_t meeting_price(const Prices& prices, const Prediction& prediction) {
  return prediction.blocks ? prices.meeting_by_blocks : prices.meeting;
}

/// What StoredBlock<N, 16>::load of a weight in Predictions(q) is to be multiplied with, an exact power of two.
template <unsigned N>
inline constexpr float weight_unit = float{StoredBlock<N, 16>::widening} * layout::prediction_unit;

}  // namespace greenloop
