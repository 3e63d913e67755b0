#include "runtime/wavelet/prediction.hpp"

namespace greenloop {

Prediction prediction_of(const ModelView& view) noexcept {
  const auto wavelet = static_cast<layout::Wavelet>(view.info->wavelet);
  if (layout::is_butterfly(wavelet)) {
    return {.length = 8, .node_work = 24};
  }
  if (wavelet != layout::Wavelet::equilibrated) {
    return {};
  }
  std::uint32_t terms = 0;
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    terms = view.level[q].predictions.terms > terms ? view.level[q].predictions.terms : terms;
  }
  return {.length = terms,
          .blocks = true,
          .node_work = 20 + 29 * terms,
          .force_work = 44,
          .pair_work = 84,
          .weight_work = 48};
}

}  // namespace greenloop
