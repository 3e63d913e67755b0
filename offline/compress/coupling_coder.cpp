#include "offline/compress/coupling_coder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace greenloop::offline {
namespace {

constexpr std::size_t width = 9;

using Block = std::array<std::int16_t, width>;

double largest_value(std::uint32_t layer) {
  return std::ldexp(1, static_cast<int>(layout::layer[layer].value_bits) - 1) - 1;
}

double largest(const float* value) {
  float most = 0;
  for (std::size_t k = 0; k < width; ++k) most = std::max(most, std::abs(value[k]));
  return static_cast<double>(most);
}

Block quantize(const float* value, double quantum) {
  Block block;
  for (std::size_t k = 0; k < width; ++k) {
    block[k] = static_cast<std::int16_t>(std::lround(static_cast<double>(value[k]) / quantum));
  }
  return block;
}

// the common quantum; in the first layer one that holds the largest value
void choose_quanta(const WaveletCompliance& compliance, double quantum, layout::Info& info) {
  std::fill(std::begin(info.quantum), std::end(info.quantum), static_cast<float>(quantum));
  double most = 0;
  for (const auto& level : compliance.couplings) {
    for (std::size_t b = 0; b < level.row.size(); ++b) most = std::max(most, largest(level.value.data() + width * b));
  }
  info.quantum[0] = static_cast<float>(std::max(quantum, most / largest_value(0)));
}

// the layer of fewest bits that holds a block; the first holds all
std::uint32_t layer_of(const float* value, const layout::Info& info, bool field) {
  for (std::uint32_t layer = layout::layers; layer-- > 1;) {
    const bool fits = largest(value) < (largest_value(layer) + 0.5) * static_cast<double>(info.quantum[layer]);
    const bool serves = layout::layer[layer].field == field || layout::layer[layer].value_bits == 16;
    if (serves && fits) return layer;
  }
  return 0;
}

// how much larger a coefficient's own diagonal block is than its scale, over its weight
std::vector<double> field_sizes(const std::vector<CoefficientScale>& scales, const Encoding& encoding) {
  std::vector<double> sizes;
  sizes.reserve(scales.size());
  for (const auto& scale : scales) sizes.push_back(std::sqrt(scale.diagonal().trace() / 3));
  for (std::size_t i = 0; i < encoding.field_weight.size(); ++i) sizes[i] /= encoding.field_weight[i];
  return sizes;
}

}  // namespace

void encode_couplings(const WaveletCompliance& compliance, const Encoding& encoding, ModelData& model) {
  choose_quanta(compliance, encoding.quantum, model.info);
  const std::vector<double> sizes = field_sizes(compliance.scales, encoding);
  std::size_t column = 0;
  for (std::size_t level = 0; level < compliance.couplings.size(); ++level) {
    const CouplingCandidates& from = compliance.couplings[level];
    LevelData& to = model.levels[level];
    to.scales.clear();
    for (auto& layer : to.couplings) layer = {.begin = {0}, .index = {}, .value = {}};
    for (std::size_t j = 0; j + 1 < from.begin.size(); ++j, ++column) {
      to.scales.push_back(compliance.scales[column].stored());
      for (std::size_t b = from.begin[j]; b < from.begin[j + 1]; ++b) {
        const auto norm = static_cast<double>(from.norm[b]);
        if (norm < encoding.threshold) continue;
        const float* value = from.value.data() + width * b;
        const bool field = norm >= encoding.field_threshold * sizes[from.row[b]] * sizes[column];
        const std::uint32_t layer = layer_of(value, model.info, field);
        const Block block = quantize(value, static_cast<double>(model.info.quantum[layer]));
        if (std::all_of(block.begin(), block.end(), [](std::int16_t q) { return q == 0; })) continue;
        to.couplings[layer].index.push_back(from.row[b]);
        to.couplings[layer].value.insert(to.couplings[layer].value.end(), block.begin(), block.end());
      }
      for (auto& layer : to.couplings) layer.begin.push_back(static_cast<std::uint32_t>(layer.index.size()));
    }
  }
}

}  // namespace greenloop::offline
