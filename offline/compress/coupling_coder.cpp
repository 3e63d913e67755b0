#include "offline/compress/coupling_coder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "offline/compress/scale.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = 9;
constexpr int layers = 3;
constexpr std::uint32_t bits[layers] = {16, 8, 4};         // by layout::Strength
constexpr double largest_value[layers] = {32767, 127, 7};  // quanta
constexpr int strong = static_cast<int>(layout::Strength::strong);

using Block = std::array<std::int16_t, width>;

Block quantize(const float* value, double quantum) {
  Block block;
  for (std::size_t k = 0; k < width; ++k) {
    block[k] = static_cast<std::int16_t>(std::lround(static_cast<double>(value[k]) / quantum));
  }
  return block;
}

double largest(const float* value) {
  float most = 0;
  for (std::size_t k = 0; k < width; ++k) most = std::max(most, std::abs(value[k]));
  return static_cast<double>(most);
}

// the layer of fewest bits that holds a block
int layer_of(const float* value, double quantum) {
  int layer = layers - 1;
  while (layer > strong && largest(value) >= (largest_value[layer] + 0.5) * quantum) --layer;
  return layer;
}

// the common quantum, or a larger one where 16 bits would not hold the largest value
double strong_quantum(const CouplingCandidates& candidates, double quantum) {
  double most = 0;
  for (std::size_t b = 0; b < candidates.row.size(); ++b) {
    most = std::max(most, largest(candidates.value.data() + width * b));
  }
  return std::max(quantum, most / largest_value[strong]);
}

// how much larger a coefficient's own diagonal block is than its scale
std::vector<double> own_sizes(const std::vector<CoefficientScale>& scales) {
  std::vector<double> sizes;
  for (const auto& scale : scales) sizes.push_back(std::sqrt(scale.diagonal().trace() / 3));
  return sizes;
}

void encode_partner(const CouplingCandidates& candidates, const std::vector<double>& row_sizes,
                    const std::vector<double>& column_sizes, const Encoding& encoding,
                    std::array<CouplingsData, layout::strengths>& to) {
  const auto common = static_cast<double>(static_cast<float>(encoding.quantum));  // as the file has it
  for (int layer = 0; layer < layers; ++layer) {
    const double quantum = layer == strong ? strong_quantum(candidates, common) : common;
    to[layer] = {
        .value_bits = bits[layer], .quantum = static_cast<float>(quantum), .begin = {0}, .index = {}, .value = {}};
  }
  for (std::size_t j = 0; j + 1 < candidates.begin.size(); ++j) {
    for (std::size_t b = candidates.begin[j]; b < candidates.begin[j + 1]; ++b) {
      if (static_cast<double>(candidates.norm[b]) < encoding.threshold) continue;
      const float* value = candidates.value.data() + width * b;
      const double own_norm =
          static_cast<double>(candidates.norm[b]) / (row_sizes[candidates.row[b]] * column_sizes[j]);
      CouplingsData& layer =
          to[static_cast<std::size_t>(own_norm >= encoding.field_threshold ? strong : layer_of(value, common))];
      const Block block = quantize(value, static_cast<double>(layer.quantum));
      if (std::all_of(block.begin(), block.end(), [](std::int16_t q) { return q == 0; })) continue;
      layer.index.push_back(candidates.row[b]);
      layer.value.insert(layer.value.end(), block.begin(), block.end());
    }
    for (int layer = 0; layer < layers; ++layer) {
      to[layer].begin.push_back(static_cast<std::uint32_t>(to[layer].index.size()));
    }
  }
}

// level 0 keeps everything
void encode_base(const CouplingCandidates& candidates, CouplingsData& data) {
  double most = 0;
  for (std::size_t b = 0; b < candidates.row.size(); ++b) {
    most = std::max(most, largest(candidates.value.data() + width * b));
  }
  data = {.value_bits = 16,
          .quantum = static_cast<float>(most / largest_value[strong]),
          .begin = {},
          .index = {},
          .value = {}};
  for (std::size_t b = 0; b < candidates.row.size(); ++b) {
    const Block block = quantize(candidates.value.data() + width * b, static_cast<double>(data.quantum));
    data.value.insert(data.value.end(), block.begin(), block.end());
  }
  for (const std::size_t begin : candidates.begin) data.begin.push_back(static_cast<std::uint32_t>(begin));
}

std::vector<layout::Scale> stored(const std::vector<CoefficientScale>& scales) {
  std::vector<layout::Scale> result;
  result.reserve(scales.size());
  for (const auto& scale : scales) result.push_back(scale.stored());
  return result;
}

}  // namespace

void encode_couplings(const CompliancePyramid& pyramid, const Encoding& encoding, ModelData& model) {
  for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
    const auto& from = pyramid.levels[level];
    auto& to = model.levels[level];
    to.details = stored(from.details);
    to.averages = stored(from.averages);
    if (level == 0) {
      const int same = static_cast<int>(layout::Partner::same);
      encode_base(from.partner[same], to.couplings[same][strong]);
      continue;
    }
    const std::vector<double> own = own_sizes(from.details);
    const auto averages = static_cast<std::size_t>(layout::Partner::averages);
    const auto parents = static_cast<std::size_t>(layout::Partner::parents);
    const auto same = static_cast<std::size_t>(layout::Partner::same);
    encode_partner(from.partner[averages], own_sizes(pyramid.levels[level > 2 ? level - 2 : 0].averages), own, encoding,
                   to.couplings[averages]);
    if (level > 1) {
      encode_partner(from.partner[parents], own_sizes(pyramid.levels[level - 1].details), own, encoding,
                     to.couplings[parents]);
    }
    encode_partner(from.partner[same], own, own, encoding, to.couplings[same]);
  }
}

}  // namespace greenloop::offline
