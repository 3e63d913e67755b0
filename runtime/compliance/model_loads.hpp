#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"
#include "runtime/wavelet/reach.hpp"

namespace greenloop {

/// Loads of a model that act, each by what it displaces: B beta of James & Pai (2003, section 3), in wavelet
/// coefficients.
struct ActingLoads {
  std::uint32_t count = 0;
  const std::uint32_t* load = nullptr;  ///< [count] their numbers in the model
  const float* amount = nullptr;        ///< [count] of their units
};

/// x += the displacement by loads, on coefficients that are touched. For the loop; work: Prices::scaled_sum per
/// coefficient and load.
void add_loads(const ModelView& view, const ActingLoads& loads, const Touched& touched, Float4* x) noexcept;

/// The same on all coefficients of levels 0..details.
void add_loads(const ModelView& view, const ActingLoads& loads, std::uint32_t details, Float4* x) noexcept;

/// The largest magnitude of a load's coefficients, m a unit. Start-up; linear in the domain.
[[nodiscard]] double largest_coefficient(const ModelView& view, std::uint32_t load) noexcept;

}  // namespace greenloop
