#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/view.hpp"
#include "formats/writer.hpp"

namespace greenloop::transport {

/// A block of couplings, of whichever layer.
struct CouplingBlock {
  std::uint32_t row = 0;
  std::uint32_t layer = 0;
  std::array<std::int16_t, 9> value{};  ///< element 3 c + r: row r of the block, column c
};

/// All layers of the couplings of one level and partner, joined: a block belongs to one layer.
struct CouplingBlocks {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  bool triangular = false;              ///< rows lie before their column
  bool dense = false;                   ///< every block there can be, in layer 0
  std::vector<std::uint32_t> bits{};    ///< of a value in each layer
  std::vector<std::uint32_t> begin{};   ///< [columns + 1]
  std::vector<CouplingBlock> blocks{};  ///< by columns, rows increasing
};

/// The contents of one layer, as the writer takes them. Work: linear.
[[nodiscard]] CouplingsData read_couplings(const CouplingsView& view);

/// Joins layers with the same columns and rows; nothing if two of them hold the same block. `joined` says what is
/// known besides. Work: linear but for sorting each column.
[[nodiscard]] std::optional<CouplingBlocks> join_layers(CouplingBlocks joined, std::span<const CouplingsData> layers);

/// Takes the blocks of one layer out again; value_bits and quantum of `data` are left as they are.
void take_layer(const CouplingBlocks& joined, std::uint32_t layer, CouplingsData& data);

}  // namespace greenloop::transport
