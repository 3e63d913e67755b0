#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/view.hpp"
#include "formats/write/writer.hpp"

namespace greenloop::transport {

/// A block of couplings, of whichever layer.
struct CouplingBlock {
  std::uint32_t row = 0;
  std::uint32_t layer = 0;
  std::array<std::int16_t, 9> value{};  ///< element N c + r: row r of the block, column c; N x N of them
};

/// All layers of the couplings of one level, joined: a block belongs to one layer.
struct CouplingBlocks {
  std::uint32_t components = 3;  ///< N: 1 or 3
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;               ///< all coefficients; the columns are the last of them
  std::vector<std::uint32_t> begin{};   ///< [columns + 1]
  std::vector<CouplingBlock> blocks{};  ///< by columns, rows increasing, before the column's
};

/// The largest magnitude a layer holds.
[[nodiscard]] constexpr std::int32_t largest_value(std::uint32_t layer) {
  return (1 << (layout::value_bits[layer] - 1)) - 1;
}

/// Joins the layers of a level with so many columns and rows; nothing if two of them hold the same block. Work: linear
/// but for sorting each column.
[[nodiscard]] std::optional<CouplingBlocks> join_layers(const LevelView& level, std::uint32_t components,
                                                        std::uint32_t columns, std::uint32_t rows);

/// The blocks of one layer again, as the writer takes them.
[[nodiscard]] CouplingsData take_layer(const CouplingBlocks& joined, std::uint32_t layer);

}  // namespace greenloop::transport
