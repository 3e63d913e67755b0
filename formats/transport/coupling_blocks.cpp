#include "formats/transport/coupling_blocks.hpp"

#include <algorithm>

#include "formats/stored_blocks.hpp"

namespace greenloop::transport {
namespace {

template <unsigned N>
void append_column(const CouplingsView& view, std::uint32_t layer, std::uint32_t column,
                   std::vector<CouplingBlock>& blocks) {
  if (column >= view.columns) return;  // of an empty section
  for (std::uint32_t b = view.begin[column]; b < view.begin[column + 1]; ++b) {
    CouplingBlock block{.row = stored_row(view, b), .layer = layer};
    for (std::uint32_t k = 0; k < N * N; ++k) block.value[k] = stored_value<N>(view, layout::value_bits[layer], b, k);
    blocks.push_back(block);
  }
}

}  // namespace

std::optional<CouplingBlocks> join_layers(const LevelView& level, std::uint32_t components, std::uint32_t columns,
                                          std::uint32_t rows) {
  const auto append = components == 1 ? append_column<1> : append_column<3>;
  CouplingBlocks joined{.components = components, .columns = columns, .rows = rows};
  auto& blocks = joined.blocks;
  joined.begin = {0};
  for (std::uint32_t j = 0; j < columns; ++j) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      append(level.couplings[layer], layer, j, blocks);
    }
    const auto column = blocks.begin() + joined.begin.back();
    std::sort(column, blocks.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
    const auto twice =
        std::adjacent_find(column, blocks.end(), [](const auto& a, const auto& b) { return a.row == b.row; });
    if (twice != blocks.end()) return std::nullopt;
    joined.begin.push_back(static_cast<std::uint32_t>(blocks.size()));
  }
  return joined;
}

CouplingsData take_layer(const CouplingBlocks& joined, std::uint32_t layer) {
  const std::uint32_t elements = joined.components * joined.components;
  CouplingsData data{.begin = {0}, .index = {}, .value = {}};
  for (std::uint32_t j = 0; j < joined.columns; ++j) {
    for (std::uint32_t b = joined.begin[j]; b < joined.begin[j + 1]; ++b) {
      const CouplingBlock& block = joined.blocks[b];
      if (block.layer != layer) continue;
      data.index.push_back(block.row);
      data.value.insert(data.value.end(), block.value.begin(), block.value.begin() + elements);
    }
    data.begin.push_back(static_cast<std::uint32_t>(data.index.size()));
  }
  return data;
}

}  // namespace greenloop::transport
