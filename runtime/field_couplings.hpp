#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/arena.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

// The couplings of the field layers, copied at start-up so that everything a coefficient's force moves stands in one
// list: the blocks of its column, and those of its row transposed. Their values are upper halves of floats
// (field_value), which load without conversion.

/// A block of a list, in quanta.
struct alignas(8) FieldBlock {
  std::uint32_t byte_offset;  ///< of the moved node in an array of Float4 per node
  std::uint16_t value[9];     ///< by columns, upper halves of floats
  std::uint16_t zero;
};

/// The lists of all layers that share a quantum: of every coefficient, and within it of every level of what it moves.
struct FieldLists {
  float quantum = 0;
  const std::uint32_t* begin = nullptr;  ///< [domain * levels + 1] into block
  const FieldBlock* block = nullptr;
};

/// All field layers.
struct FieldCouplings {
  std::uint32_t levels = 0;
  std::uint32_t quanta = 0;
  FieldLists of_quantum[layout::field_layers];  ///< [quanta]
};

/// Carves the lists out of `arena` and fills them in, unless it only counts. level: [domain] mesh levels. Start-up;
/// linear in the blocks.
[[nodiscard]] FieldCouplings place_field_couplings(Arena& arena, const ModelView& view,
                                                   const std::uint8_t* level) noexcept;

/// Blocks in a coefficient's lists that move coefficients of levels 0..field_level. For the loop; work: 6 units.
inline std::uint32_t field_blocks(const FieldCouplings& couplings, std::uint32_t coefficient,
                                  std::uint32_t field_level) {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  const std::size_t end = first + field_level + 1;
  std::uint32_t blocks = 0;
  for (std::uint32_t n = 0; n < couplings.quanta; ++n) {
    blocks += couplings.of_quantum[n].begin[end] - couplings.of_quantum[n].begin[first];
  }
  return blocks;
}

/// Asks the processor for a coefficient's lists.
void prefetch_couplings(const FieldCouplings& couplings, std::uint32_t coefficient) noexcept;

/// x += the blocks of a coefficient with those of levels 0..field_level, times its scaled force. x: [node_count], by
/// file index. For the loop; work: 9 units per block.
void add_couplings(const FieldCouplings& couplings, std::uint32_t coefficient, std::uint32_t field_level, Float4 force,
                   Float4* x) noexcept;

}  // namespace greenloop
