#include "formats/transport/coupling_blocks.hpp"

#include <algorithm>

namespace greenloop::transport {
namespace {

std::int16_t element(const CouplingsView& view, std::size_t block, std::size_t k) {
  if (view.value_bits == 16) return reinterpret_cast<const std::int16_t*>(view.value)[9 * block + k];
  if (view.value_bits == 8) return reinterpret_cast<const std::int8_t*>(view.value)[9 * block + k];
  const auto nibble = std::to_integer<int>(view.value[5 * block + k / 2]) >> (4 * (k % 2)) & 15;
  return static_cast<std::int16_t>(nibble < 8 ? nibble : nibble - 16);
}

std::uint32_t row(const CouplingsView& view, std::size_t block) {
  return view.index_bytes == 2 ? static_cast<const std::uint16_t*>(view.index)[block]
                               : static_cast<const std::uint32_t*>(view.index)[block];
}

}  // namespace

CouplingsData read_couplings(const CouplingsView& view) {
  CouplingsData data{.value_bits = view.value_bits, .quantum = view.quantum, .begin = {}, .index = {}, .value = {}};
  data.begin.assign(view.begin, view.begin + view.columns + 1);
  const std::size_t blocks = data.begin.back();
  for (std::size_t b = 0; b < blocks && view.index_bytes != 0; ++b) data.index.push_back(row(view, b));
  data.value.reserve(9 * blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t k = 0; k < 9; ++k) data.value.push_back(element(view, b, k));
  }
  return data;
}

std::optional<CouplingBlocks> join_layers(CouplingBlocks joined, std::span<const CouplingsData> layers) {
  joined.begin = {0};
  for (const CouplingsData& data : layers) joined.bits.push_back(data.value_bits);
  for (std::uint32_t j = 0; j < joined.columns; ++j) {
    for (std::uint32_t layer = 0; layer < layers.size(); ++layer) {
      const CouplingsData& data = layers[layer];
      for (std::uint32_t b = data.begin[j]; b < data.begin[j + 1]; ++b) {
        CouplingBlock block{.row = joined.dense ? b - data.begin[j] : data.index[b], .layer = layer};
        std::copy_n(&data.value[9 * std::size_t{b}], 9, block.value.begin());
        joined.blocks.push_back(block);
      }
    }
    const auto column = joined.blocks.begin() + joined.begin.back();
    std::sort(column, joined.blocks.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
    const auto twice =
        std::adjacent_find(column, joined.blocks.end(), [](const auto& a, const auto& b) { return a.row == b.row; });
    if (twice != joined.blocks.end()) return std::nullopt;
    joined.begin.push_back(static_cast<std::uint32_t>(joined.blocks.size()));
  }
  return joined;
}

void take_layer(const CouplingBlocks& joined, std::uint32_t layer, CouplingsData& data) {
  data.begin = {0};
  data.index.clear();
  data.value.clear();
  std::uint32_t count = 0;
  for (std::uint32_t j = 0; j < joined.columns; ++j) {
    for (std::uint32_t b = joined.begin[j]; b < joined.begin[j + 1]; ++b) {
      const CouplingBlock& block = joined.blocks[b];
      if (block.layer != layer) continue;
      if (!joined.dense) data.index.push_back(block.row);
      data.value.insert(data.value.end(), block.value.begin(), block.value.end());
      ++count;
    }
    data.begin.push_back(count);
  }
}

}  // namespace greenloop::transport
