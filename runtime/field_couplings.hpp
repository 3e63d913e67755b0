#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/arena.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

// The couplings of the field layers with their scales multiplied in (field_block), copied at start-up so that
// everything a coefficient's force moves stands in one list: the blocks of its column, and those of its row transposed.
// Values are upper halves of floats, which load without conversion.

/// A block of a list, m/N.
struct alignas(8) FieldBlock {
  std::uint32_t byte_offset;  ///< of the moved node in an array of Float4 per node
  std::uint16_t value[9];     ///< by columns, upper halves of floats
  std::uint16_t zero;
};

/// A coefficient's own block, symmetric: xx, xy, xz, yy, yz, zz; m/N.
struct OwnBlock {
  float element[6];
};

/// All field layers.
struct FieldCouplings {
  std::uint32_t levels = 0;
  const OwnBlock* own = nullptr;         ///< [domain]
  const std::uint32_t* begin = nullptr;  ///< [domain * levels + 1] into block: of every coefficient, by the moved level
  const FieldBlock* block = nullptr;
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
  return couplings.begin[end] - couplings.begin[first];
}

/// Asks the processor for a coefficient's lists.
void prefetch_couplings(const FieldCouplings& couplings, std::uint32_t coefficient) noexcept;

/// x += the blocks of a coefficient with others of levels 0..field_level, times the force on it. x: [node_count], by
/// file index. For the loop; work: 9 units per block.
void add_couplings(const FieldCouplings& couplings, std::uint32_t coefficient, std::uint32_t field_level, Float4 force,
                   Float4* x) noexcept;

}  // namespace greenloop
