#include "offline/compress/coupling_coder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "offline/compress/scale.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = 9;
constexpr double largest_weak = 7;  // quanta
constexpr int strong = static_cast<int>(layout::Strength::strong), weak = static_cast<int>(layout::Strength::weak);

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

bool is_weak(const float* value, double quantum) { return largest(value) < (largest_weak + 0.5) * quantum; }

void append(CouplingsData& data, std::uint32_t row, const Block& block) {
  data.index.push_back(row);
  data.value.insert(data.value.end(), block.begin(), block.end());
}

// the least quantum that every kept strong value fits
double strong_quantum(const CouplingCandidates& candidates, const Encoding& encoding) {
  double most = 0;
  for (std::size_t b = 0; b < candidates.row.size(); ++b) {
    const float* value = candidates.value.data() + width * b;
    if (static_cast<double>(candidates.norm[b]) >= encoding.threshold && !is_weak(value, encoding.weak_quantum)) {
      most = std::max(most, largest(value));
    }
  }
  return most / ((1 << (encoding.strong_bits - 1)) - 1);
}

void encode_partner(const CouplingCandidates& candidates, const Encoding& encoding, CouplingsData (&layers)[2]) {
  const auto quantum = static_cast<float>(strong_quantum(candidates, encoding));
  layers[strong] = {.value_bits = encoding.strong_bits, .quantum = quantum, .begin = {0}, .index = {}, .value = {}};
  layers[weak] = {.value_bits = 4,
                  .quantum = static_cast<float>(encoding.weak_quantum),
                  .begin = {0},
                  .index = {},
                  .value = {}};
  for (std::size_t j = 0; j + 1 < candidates.begin.size(); ++j) {
    for (std::size_t b = candidates.begin[j]; b < candidates.begin[j + 1]; ++b) {
      if (static_cast<double>(candidates.norm[b]) < encoding.threshold) continue;
      const float* value = candidates.value.data() + width * b;
      if (!is_weak(value, encoding.weak_quantum)) {
        append(layers[strong], candidates.row[b], quantize(value, static_cast<double>(quantum)));
      } else if (const Block block = quantize(value, encoding.weak_quantum);
                 std::any_of(block.begin(), block.end(), [](std::int16_t q) { return q != 0; })) {
        append(layers[weak], candidates.row[b], block);
      }
    }
    for (auto& layer : layers) layer.begin.push_back(static_cast<std::uint32_t>(layer.index.size()));
  }
}

// level 0 keeps everything
void encode_base(const CouplingCandidates& candidates, CouplingsData& data) {
  double most = 0;
  for (std::size_t b = 0; b < candidates.row.size(); ++b) {
    most = std::max(most, largest(candidates.value.data() + width * b));
  }
  data = {.value_bits = 16, .quantum = static_cast<float>(most / 32767), .begin = {}, .index = {}, .value = {}};
  for (std::size_t b = 0; b < candidates.row.size(); ++b) {
    const Block block = quantize(candidates.value.data() + width * b, static_cast<double>(data.quantum));
    data.value.insert(data.value.end(), block.begin(), block.end());
  }
  for (const std::size_t begin : candidates.begin) data.begin.push_back(static_cast<std::uint32_t>(begin));
}

std::vector<layout::Scale> scales(const std::vector<Eigen::Matrix3d>& blocks, std::string_view role) {
  std::vector<layout::Scale> result;
  for (std::size_t i = 0; i < blocks.size(); ++i) result.push_back(store_scale(Scale(blocks[i], role, i).root()));
  return result;
}

}  // namespace

void encode_couplings(const CompliancePyramid& pyramid, const Encoding& encoding, ModelData& model) {
  for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
    const auto& from = pyramid.levels[level];
    auto& to = model.levels[level];
    to.details = scales(from.details, "detail");
    to.averages = scales(from.averages, "average");
    if (level == 0) {
      const int same = static_cast<int>(layout::Partner::same);
      encode_base(from.partner[same], to.couplings[same][strong]);
      continue;
    }
    for (std::size_t partner = 0; partner < 3; ++partner) {
      if (level == 1 && partner == static_cast<std::size_t>(layout::Partner::parents)) continue;
      encode_partner(from.partner[partner], encoding, to.couplings[partner]);
    }
  }
}

}  // namespace greenloop::offline
