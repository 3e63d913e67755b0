#pragma once

// Probabilities that learn, and their mixture in the logistic domain (Mahoney 2005, "Adaptive weighing of context
// models for lossless data compression"). Integer arithmetic only, so that writer and reader agree on every machine.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/transport/range_coder.hpp"

namespace greenloop::transport {

/// The probability of a one, learned from the bits seen: their mean at first, later a moving average.
class AdaptiveBit {
 public:
  /// In 1/65536, 1 .. 65535.
  [[nodiscard]] std::uint32_t probability() const { return probability_ >> 6; }
  /// How many bits were seen, up to the length of the average.
  [[nodiscard]] std::uint32_t seen() const { return seen_; }
  void learn(bool bit);
  bool code(BitCoder& coder, bool bit);

 private:
  std::uint32_t probability_ : 22 = 1U << 21;
  std::uint32_t seen_ : 10 = 0;
};

/// 256 times ln(p / (1 - p)) of a probability in 1/65536, rounded, within -2047 .. 2047.
[[nodiscard]] std::int32_t stretch(std::uint32_t probability);

/// The inverse; 16 .. 65520 or so, argument clamped to -2047 .. 2047.
[[nodiscard]] std::uint32_t squash(std::int32_t logit);

/// One kind of decision, predicted from several contexts at once. Each context has its own table of probabilities; what
/// they say is weighed by weights that learn which context knows best.
class MixedBit {
 public:
  /// sizes[k]: number of values of context k. `selectors`: number of sets of weights.
  MixedBit(std::span<const std::uint32_t> sizes, std::uint32_t selectors);

  /// contexts[k] < sizes[k], selector < selectors.
  bool code(BitCoder& coder, bool bit, std::span<const std::uint32_t> contexts, std::uint32_t selector);

 private:
  std::vector<std::uint32_t> begin_;  // of each context's table
  std::vector<AdaptiveBit> bits_;
  std::vector<std::int32_t> weights_;  // [selectors][contexts + 1], in 1/65536; the last one of a constant
  std::vector<std::int32_t> logits_;
};

}  // namespace greenloop::transport
