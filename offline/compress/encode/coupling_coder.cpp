#include "offline/compress/encode/coupling_coder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace greenloop::offline {
namespace {

template <unsigned N>
using Values = std::array<double, N * N>;  // of a scaled block

double largest_value(std::uint32_t layer) { return std::ldexp(1, static_cast<int>(layout::value_bits[layer]) - 1) - 1; }

double largest(std::span<const double> values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

// stores the multiples of a layer's quantum nearest to the values, unless all are zero; what is left of the values
template <unsigned N>
Values<N> add_block(Values<N> values, float quantum, std::uint32_t row, CouplingsData& layer) {
  std::array<std::int16_t, N * N> block{};
  for (std::size_t k = 0; k < block.size(); ++k) {
    block[k] = static_cast<std::int16_t>(std::lround(values[k] / static_cast<double>(quantum)));
    values[k] -= static_cast<double>(quantum) * block[k];
  }
  if (std::any_of(block.begin(), block.end(), [](std::int16_t q) { return q != 0; })) {
    layer.index.push_back(row);
    layer.value.insert(layer.value.end(), block.begin(), block.end());
  }
  return values;
}

// the common quantum; in the first layer one that holds the largest value
template <unsigned N>
void choose_quanta(const WaveletCompliance<N>& compliance, const Encoding& encoding, layout::Info& info) {
  const double quantum = encoding.quantum;
  std::fill(std::begin(info.quantum), std::end(info.quantum), static_cast<float>(quantum));
  double most = 0;
  for (const auto& level : compliance.couplings) {
    for (const float value : level.value) most = std::max(most, static_cast<double>(std::abs(value)));
  }
  if (most > largest_value(0)) {  // a quantum is at most 1
    throw std::runtime_error("compression: a coupling is " + std::to_string(most) +
                             " times its coefficients' stiffness, at most " + std::to_string(largest_value(0)) +
                             " can be stored: the body is too thin for its nodes; thicken it or take fewer levels");
  }
  info.quantum[0] = static_cast<float>(std::max(quantum, most / largest_value(0)));
}

// the layer of fewest bits that holds a block; the first holds all
std::uint32_t layer_of(std::span<const double> values, const layout::Info& info) {
  std::uint32_t layer = layout::layers - 1;
  while (layer > 0 && largest(values) >= (largest_value(layer) + 0.5) * static_cast<double>(info.quantum[layer]))
    --layer;
  return layer;
}

}  // namespace

template <unsigned N>
void encode_couplings(const WaveletCompliance<N>& compliance, const Encoding& encoding, ModelData& model) {
  choose_quanta(compliance, encoding, model.info);
  std::size_t column = 0;
  for (std::size_t level = 0; level < compliance.couplings.size(); ++level) {
    const CouplingCandidates<N>& from = compliance.couplings[level];
    LevelData& to = model.levels[level];
    to.scales = {};
    for (auto& layer : to.couplings) layer = {.begin = {0}, .index = {}, .value = {}};
    for (std::size_t j = 0; j + 1 < from.begin.size(); ++j, ++column) {
      to.scales.push_back<N>(compliance.scales[column].stored(encoding.quantum));
      for (std::size_t b = from.begin[j]; b < from.begin[j + 1]; ++b) {
        if (static_cast<double>(from.norm[b]) < encoding.threshold) continue;
        Values<N> values;
        std::copy_n(from.value.begin() + static_cast<std::ptrdiff_t>(values.size() * b), values.size(), values.begin());
        std::uint32_t layer = layer_of(values, model.info);
        if (layer == 0) {  // too coarse alone: what is left of the block stands in a finer layer
          values = add_block<N>(values, model.info.quantum[0], from.row[b], to.couplings[0]);
          layer = layer_of(values, model.info);
        }
        (void)add_block<N>(values, model.info.quantum[layer], from.row[b], to.couplings[layer]);
      }
      for (auto& layer : to.couplings) layer.begin.push_back(static_cast<std::uint32_t>(layer.index.size()));
    }
  }
}

template void encode_couplings(const WaveletCompliance<1>&, const Encoding&, ModelData&);
template void encode_couplings(const WaveletCompliance<3>&, const Encoding&, ModelData&);

}  // namespace greenloop::offline
