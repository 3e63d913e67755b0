#include "formats/transport/adaptive_bit.hpp"

#include <algorithm>
#include <array>

namespace greenloop::transport {
namespace {

constexpr std::uint32_t longest_average = 400;
constexpr std::int32_t largest_logit = 2047;
constexpr std::int32_t largest_weight = 1 << 22;
constexpr std::int32_t one = 256;  // the logit that always speaks

// 65536 / (n + 1.5)
constexpr auto rates = [] {
  std::array<std::uint32_t, longest_average + 1> table{};
  for (std::uint32_t n = 0; n <= longest_average; ++n) table[n] = 2 * 65536 / (2 * n + 3);
  return table;
}();

// of the logits 0 .. 2047: 65536 / (1 + e^(-k/256)), from powers of e^(1/256) with 32 binary places
constexpr auto squashed = [] {
  std::array<std::uint32_t, largest_logit + 1> table{};
  constexpr std::uint64_t step = 4311777323;  // 2^32 e^(1/256)
  std::uint64_t power = std::uint64_t{1} << 32;
  for (std::uint32_t k = 0; k <= largest_logit; ++k) {
    const std::uint64_t odds = power >> 16;  // 16 binary places, below 2^28
    table[k] = static_cast<std::uint32_t>((odds << 16) / (odds + 65536));
    power = (power >> 12) * (step >> 12) >> 8;
  }
  return table;
}();

// of the probabilities (2 k + 1) / 8192
constexpr auto stretched = [] {
  std::array<std::int16_t, 4096> table{};
  std::uint32_t logit = 0;
  for (std::uint32_t k = 2048; k < 4096; ++k) {
    while (logit < largest_logit && squashed[logit] < 16 * k + 8) ++logit;
    table[k] = static_cast<std::int16_t>(logit);
    table[4095 - k] = static_cast<std::int16_t>(-table[k]);
  }
  return table;
}();

void move(std::int32_t& weight, std::int32_t gradient) {
  weight = std::clamp(weight + gradient / (1 << 16), -largest_weight, largest_weight);
}

}  // namespace

void AdaptiveBit::learn(bool bit) {
  const auto target = static_cast<std::int64_t>(bit ? (1 << 22) - 64 : 63);
  const std::int64_t step = (target - static_cast<std::int64_t>(probability_)) * rates[seen_] / 65536;
  probability_ = static_cast<std::uint32_t>(static_cast<std::int64_t>(probability_) + step) & 0x3fffff;
  if (seen_ < longest_average) seen_ = (seen_ + 1) & 0x3ff;
}

bool AdaptiveBit::code(BitCoder& coder, bool bit) {
  bit = coder.code(bit, std::clamp<std::uint32_t>(probability(), 1, 65535));
  learn(bit);
  return bit;
}

std::int32_t stretch(std::uint32_t probability) { return stretched[probability >> 4]; }

std::uint32_t squash(std::int32_t logit) {
  return logit < 0 ? 65536 - squashed[static_cast<std::size_t>(std::min(-logit, largest_logit))]
                   : squashed[static_cast<std::size_t>(std::min(logit, largest_logit))];
}

MixedBits::MixedBits(std::span<const std::uint32_t> sizes, std::uint32_t selectors, std::uint32_t decisions)
    : decisions_(decisions) {
  std::size_t size = 0;
  for (const std::uint32_t values : sizes) {
    begin_.push_back(size);
    size += std::size_t{values} * decisions;
  }
  bits_.resize(size);
  Weights equal{};
  equal.of_context.fill(static_cast<std::int32_t>((2 << 16) / (sizes.size() + 3)));
  weights_.assign(std::size_t{selectors} * decisions, equal);
}

bool MixedBits::code(BitCoder& coder, bool bit, std::span<const std::uint32_t> contexts, std::uint32_t selector,
                     std::uint32_t decision) {
  Weights& weights = weights_[std::size_t{selector} * decisions_ + decision];
  std::array<AdaptiveBit*, most_contexts> bits;
  std::array<std::int32_t, most_contexts> logits;
  std::int64_t sum = std::int64_t{weights.of_one} * one;
  for (std::size_t k = 0; k < contexts.size(); ++k) {
    bits[k] = &bits_[begin_[k] + std::size_t{contexts[k]} * decisions_ + decision];
    logits[k] = stretch(bits[k]->probability());
    sum += std::int64_t{weights.of_context[k]} * logits[k];
  }
  const std::uint32_t probability =
      squash(static_cast<std::int32_t>(std::clamp<std::int64_t>(sum / 65536, -largest_logit, largest_logit)));
  bit = coder.code(bit, probability);
  const std::int32_t error = (bit ? 65536 : 0) - static_cast<std::int32_t>(probability);
  for (std::size_t k = 0; k < contexts.size(); ++k) {
    move(weights.of_context[k], logits[k] * error);
    bits[k]->learn(bit);
  }
  move(weights.of_one, one * error);
  return bit;
}

}  // namespace greenloop::transport
