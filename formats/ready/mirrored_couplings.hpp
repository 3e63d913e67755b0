#pragma once

#include <cstdint>

#include "formats/stored_blocks.hpp"
#include "formats/view.hpp"

namespace greenloop {

/// Calls visit(section, row, column among all coefficients, position in the section) for the stored blocks of a layer
/// that are mirrored, by columns: those that `base` does not hold and whose column is read. read: [domain]; null if all
/// are. Work: a visit a block, and the logarithm of its length for a column.
template <class Visit>
void visit_mirrored(const ElastostaticView& view, std::uint32_t layer, const BaseColumns& base,
                    const std::uint8_t* read, Visit visit) {
  const std::uint32_t first = base.holds[layer] ? base.columns : 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    const CouplingsView& couplings = level.couplings[layer];
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      const std::uint32_t column = level.domain_begin + j;
      if (read == nullptr || read[column] != 0) {
        visit_rows(couplings, j, first, column,
                   [&](std::uint32_t row, std::uint32_t position) { visit(couplings, row, column, position); });
      }
    }
  }
}

/// How many these are. Work: as visit_mirrored.
inline std::uint64_t count_mirrored(const ElastostaticView& view, std::uint32_t layer, const BaseColumns& base,
                                    const std::uint8_t* read) {
  std::uint64_t blocks = 0;
  visit_mirrored(view, layer, base, read,
                 [&](const CouplingsView&, std::uint32_t, std::uint32_t, std::uint32_t) { ++blocks; });
  return blocks;
}

}  // namespace greenloop
