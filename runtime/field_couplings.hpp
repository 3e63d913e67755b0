#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/arena.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

// The couplings of the field layers, copied at start-up so that everything a coefficient's force moves stands in one
// list: the blocks of its column, and those of its row transposed.

/// A block of a list, in quanta; column c of it at value[4 c], fourth rows 0.
struct alignas(16) ByteBlock {
  static constexpr float widening = 0x1p-24F;
  std::uint32_t byte_offset;  ///< of the moved node in an array of Float4 per node
  std::int8_t value[12];
};

/// The same in 16 bits.
struct alignas(32) HalfBlock {
  static constexpr float widening = 0x1p-16F;
  std::uint32_t byte_offset;
  std::uint32_t unused;
  std::int16_t value[12];
};

/// The lists of one layer: of every coefficient, and within it of every level of what it moves.
template <class Stored>
struct FieldLayer {
  float factor = 0;                      ///< value of one quantum, times the widening
  const std::uint32_t* begin = nullptr;  ///< [domain * levels + 1] into blocks
  const Stored* block = nullptr;
};

/// Layers 0..layout::field_layers-1. Values of 4 bits are kept in 8, which are quicker to load.
struct FieldCouplings {
  std::uint32_t levels = 0;
  FieldLayer<HalfBlock> halves;
  FieldLayer<ByteBlock> bytes;
  FieldLayer<ByteBlock> nibbles;
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
  return couplings.halves.begin[end] - couplings.halves.begin[first] + couplings.bytes.begin[end] -
         couplings.bytes.begin[first] + couplings.nibbles.begin[end] - couplings.nibbles.begin[first];
}

/// Asks the processor for a coefficient's lists.
void prefetch_couplings(const FieldCouplings& couplings, std::uint32_t coefficient) noexcept;

/// x += the blocks of a coefficient with those of levels 0..field_level, times its scaled force. x: [node_count], by
/// file index. For the loop; work: 9 units per block.
void add_couplings(const FieldCouplings& couplings, std::uint32_t coefficient, std::uint32_t field_level, Float4 force,
                   Float4* x) noexcept;

}  // namespace greenloop
