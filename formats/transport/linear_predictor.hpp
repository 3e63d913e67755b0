#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace greenloop::transport {

/// Weights of a linear prediction that learns after every value by normalised least mean squares (Widrow and Hoff 1960;
/// Nagumo and Noda 1967), in whole numbers. `Size` inputs of at most 2^16 in magnitude.
template <std::size_t Size>
class LinearPredictor {
 public:
  using Inputs = std::array<std::int32_t, Size>;

  /// In 1/256.
  [[nodiscard]] std::int64_t predict(const Inputs& inputs) const {
    std::int64_t sum = 0;
    for (std::size_t k = 0; k < Size; ++k) sum += std::int64_t{weights_[k]} * inputs[k];
    return sum / 256;
  }

  /// `step`: error over energy times rate, in 2^-24.
  void learn(const Inputs& inputs, std::int64_t step) {
    for (std::size_t k = 0; k < Size; ++k) {
      const std::int64_t moved = weights_[k] + step * inputs[k] / 256;
      weights_[k] = static_cast<std::int32_t>(moved < -largest ? -largest : moved > largest ? largest : moved);
    }
  }

 private:
  static constexpr std::int64_t largest = 1 << 24;
  std::array<std::int32_t, Size> weights_{};  // in 1/65536
};

}  // namespace greenloop::transport
