#pragma once

#include <cstdint>

#include "formats/layout.hpp"

namespace greenloop {

/// The first multiple of layout::alignment at or after an offset.
constexpr std::uint64_t aligned(std::uint64_t offset) {
  return (offset + layout::alignment - 1) / layout::alignment * layout::alignment;
}

/// Where the arrays of a Predictions section stand, in bytes from its start. No overflow if there are at most
/// layout::most_prediction_terms.
struct PredictionsExtent {
  std::uint64_t index, index_end, weight, weight_end;

  explicit constexpr PredictionsExtent(const layout::PredictionsHeader& header) : index(sizeof(header)) {
    const std::uint64_t blocks = std::uint64_t{header.nodes} * header.terms;
    index_end = index + blocks * header.index_bytes;
    weight = aligned(index_end);
    weight_end = weight + blocks * 9 * sizeof(std::int16_t);
  }
};

}  // namespace greenloop
