#pragma once

// Probabilities that learn, and their mixture in the logistic domain (Mahoney 2005, "Adaptive weighing of context
// models for lossless data compression"). Integer arithmetic only, so that writer and reader agree on every machine.

#include <array>
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

/// Decisions predicted from several contexts at once. Each context has its own table of probabilities; what they say is
/// weighed by weights that learn which context knows best.
class MixedBits {
 public:
  static constexpr std::size_t most_contexts = 8;

  /// sizes[k]: number of values of context k, of at most most_contexts. `selectors`: sets of weights. `decisions`:
  /// kinds of decisions, each with tables and weights of its own.
  MixedBits(std::span<const std::uint32_t> sizes, std::uint32_t selectors, std::uint32_t decisions = 1);

  /// contexts[k] < sizes[k], selector < selectors, decision < decisions.
  bool code(BitCoder& coder, bool bit, std::span<const std::uint32_t> contexts, std::uint32_t selector,
            std::uint32_t decision = 0);

 private:
  struct Weights {
    std::array<std::int32_t, most_contexts> of_context;  // in 1/65536
    std::int32_t of_one;
  };
  std::uint32_t decisions_;
  std::vector<std::size_t> begin_;  // of each context's table
  std::vector<AdaptiveBit> bits_;   // per context [value][decision]
  std::vector<Weights> weights_;    // [selector][decision]
};

}  // namespace greenloop::transport
