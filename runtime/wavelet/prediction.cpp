#include "runtime/wavelet/prediction.hpp"

namespace greenloop {
namespace {

std::uint32_t most_terms(const ModelView& view) {
  std::uint32_t terms = 0;
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    terms = view.level[q].predictions.terms > terms ? view.level[q].predictions.terms : terms;
  }
  return terms;
}

}  // namespace

Prediction prediction_of(const ModelView& view) noexcept {
  const auto wavelet = static_cast<layout::Wavelet>(view.info->wavelet);
  const std::uint32_t components = view.info->components;
  if (wavelet != layout::Wavelet::equilibrated) {
    return {.components = components,
            .length = layout::is_butterfly(wavelet) ? 8U : 2U,
            .lifted = layout::is_lifted(wavelet)};
  }
  return {.components = components,
          .length = most_terms(view),
          .blocks = true,
          .block_bytes = static_cast<std::uint32_t>(layout::block_bytes(components, 16))};
}

}  // namespace greenloop
