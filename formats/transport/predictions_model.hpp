#pragma once

#include <cstddef>
#include <span>

#include "formats/layout.hpp"
#include "formats/transport/adaptive_integer.hpp"

namespace greenloop::transport {

/// The arrays of a Predictions section, whose header has been coded: indices from those of the node before; weights
/// about 0, those of a node's last term from the others, which with them add up to the identity where a prediction
/// reproduces translations. All of a model of so many components.
class PredictionsModel {
 public:
  /// Whether `section` has terms, is as long as its header says and has its arrays where they belong.
  [[nodiscard]] static bool fits(std::span<const std::byte> section, std::uint32_t components);

  /// Of a section that fits: an encoder codes the arrays, a decoder fills them; neither touches what lies between them.
  /// Throws DamagedPacket if a number read does not fit. Work: linear in the section.
  void code(BitCoder& coder, std::span<std::byte> section, std::uint32_t components);

 private:
  AdaptiveInteger index_{layout::most_prediction_terms};
  AdaptiveInteger weight_{std::uint32_t{9} * (layout::most_prediction_terms + 1)};
};

/// The bytes of a section that fits which belong to no array: between them, and behind.
struct PredictionsGaps {
  std::span<std::byte> between, behind;
};
[[nodiscard]] PredictionsGaps gaps_of_predictions(std::span<std::byte> section, std::uint32_t components);

}  // namespace greenloop::transport
