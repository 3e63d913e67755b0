#include "runtime/wavelet/prediction.hpp"

namespace greenloop {
namespace {

Prediction from_parents(std::uint32_t components) {
  if (components == 1) {
    return {.components = 1, .node_work = 2, .detail_work = 3, .force_work = 1, .pair_work = 2, .weight_work = 1};
  }
  return {};
}

Prediction by_blocks(std::uint32_t components, std::uint32_t terms) {
  Prediction prediction = from_parents(components);
  prediction.length = terms;
  prediction.blocks = true;
  prediction.block_bytes = static_cast<std::uint32_t>(layout::block_bytes(components, 16));
  prediction.node_work = components == 1 ? 2 + terms : 20 + 29 * terms;
  prediction.force_work = components == 1 ? 2 : 44;
  prediction.pair_work = components == 1 ? 4 : 84;
  prediction.weight_work = components == 1 ? 1 : 48;
  return prediction;
}

}  // namespace

Prediction prediction_of(const ModelView& view) noexcept {
  const auto wavelet = static_cast<layout::Wavelet>(view.info->wavelet);
  const std::uint32_t components = view.info->components;
  if (layout::is_butterfly(wavelet)) {
    Prediction prediction = from_parents(components);
    prediction.length = 8;
    prediction.node_work = 8 * components;
    return prediction;
  }
  if (wavelet != layout::Wavelet::equilibrated) {
    return from_parents(components);
  }
  std::uint32_t terms = 0;
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    terms = view.level[q].predictions.terms > terms ? view.level[q].predictions.terms : terms;
  }
  return by_blocks(components, terms);
}

}  // namespace greenloop
