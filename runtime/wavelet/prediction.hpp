#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/stored_block.hpp"

namespace greenloop {

/// How a model predicts an odd node of its mesh, and the work units that this takes; by default from its two parents,
/// with three components.
struct Prediction {
  std::uint32_t components = 3;   ///< of a node
  std::uint32_t length = 2;       ///< nodes that it reads at most
  bool blocks = false;            ///< its weights are blocks, which are read in place, not numbers
  std::uint32_t block_bytes = 0;  ///< of one of those
  std::uint32_t node_work = 6;    ///< of inverse_transform, an odd node
  std::uint32_t detail_work = 8;  ///< of inverse_transform, a coefficient
  std::uint32_t force_work = 3;   ///< of transform_forces, a visit
  std::uint32_t pair_work = 18;   ///< of T^-1 of two rows of a capacitance matrix, a visit
  std::uint32_t weight_work = 9;  ///< of a block times a weight of a functional
};

/// Of a model's wavelets. Work: a unit per level.
[[nodiscard]] Prediction prediction_of(const ModelView& view) noexcept;

/// What StoredBlock<N, 16>::load of a weight in Predictions(q) is to be multiplied with, an exact power of two.
template <unsigned N>
inline constexpr float weight_unit = float{StoredBlock<N, 16>::widening} * layout::prediction_unit;

}  // namespace greenloop
