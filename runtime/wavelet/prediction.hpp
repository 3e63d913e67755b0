#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/float4.hpp"

namespace greenloop {

/// How a model predicts an odd node of its mesh, and the work units that this takes; by default from its two parents.
struct Prediction {
  std::uint32_t length = 2;       ///< nodes that it reads at most
  bool blocks = false;            ///< its weights are 3x3 blocks, which are read in place, not numbers
  std::uint32_t node_work = 6;    ///< of inverse_transform, an odd node
  std::uint32_t force_work = 3;   ///< of transform_forces, a visit
  std::uint32_t pair_work = 18;   ///< of T^-1 of two rows of a capacitance matrix, a visit
  std::uint32_t weight_work = 9;  ///< of a block times a weight of a functional
};

/// Of a model's wavelets. Work: a unit per level.
[[nodiscard]] Prediction prediction_of(const ModelView& view) noexcept;

/// What StoredBlock<16>::load of a weight in Predictions(q) is to be multiplied with, an exact power of two.
inline constexpr float weight_unit = StoredBlock<16>::widening * layout::prediction_unit;

/// Where the weight of a term of Predictions(q) stands, and those of the terms after it; term: as of stored_source.
inline const std::byte* stored_block(const PredictionsView& view, std::size_t term) {
  return view.weight + StoredBlock<16>::bytes * term;
}

}  // namespace greenloop
