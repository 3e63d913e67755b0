#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/arena.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

// The couplings of the field layers, copied at start-up so that everything a coefficient's force moves stands in one
// list: the blocks of its column, and those of its row transposed.

/// A block of a list, in quanta of at most 8 bits: by columns, the upper halves of floats, which hold them exactly and
/// load with no conversion.
struct alignas(8) NarrowBlock {
  static constexpr float widening = 1;
  std::uint32_t byte_offset;  ///< of the moved node in an array of Float4 per node
  std::uint16_t value[9];
  std::uint16_t zero;
};

/// The same in 16 bits; column c of it at value[4 c], fourth rows 0.
struct alignas(32) WideBlock {
  static constexpr float widening = 0x1p-16F;
  std::uint32_t byte_offset;
  std::uint32_t zero;
  std::int16_t value[12];
};

/// The lists of some layers that share a quantum: of every coefficient, and within it of every level of what it moves.
template <class Stored>
struct FieldLists {
  float factor = 0;                      ///< value of one quantum, times the widening
  const std::uint32_t* begin = nullptr;  ///< [domain * levels + 1] into blocks
  const Stored* block = nullptr;
};

/// Layers 0..layout::field_layers-1.
struct FieldCouplings {
  std::uint32_t levels = 0;
  FieldLists<WideBlock> wide;
  std::uint32_t narrow_lists = 0;
  FieldLists<NarrowBlock> narrow[2];  ///< [narrow_lists] one if layers of 8 and 4 bits share their quantum
};

/// Carves the lists out of `arena` and fills them in, unless it only counts. level: [domain] mesh levels. Start-up;
/// linear in the blocks.
[[nodiscard]] FieldCouplings place_field_couplings(Arena& arena, const ModelView& view,
                                                   const std::uint8_t* level) noexcept;

/// Blocks between the coefficient and those of levels 0..field_level, in all field layers. For the loop; work: 6 units.
inline std::uint32_t field_blocks(const FieldCouplings& couplings, std::uint32_t coefficient,
                                  std::uint32_t field_level) {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  const std::size_t end = first + field_level + 1;
  std::uint32_t blocks = couplings.wide.begin[end] - couplings.wide.begin[first];
  for (std::uint32_t n = 0; n < couplings.narrow_lists; ++n) {
    blocks += couplings.narrow[n].begin[end] - couplings.narrow[n].begin[first];
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
