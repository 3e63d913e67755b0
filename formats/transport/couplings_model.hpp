#pragma once

#include <span>

#include "formats/transport/adaptive_integer.hpp"
#include "formats/transport/coupling_blocks.hpp"
#include "formats/transport/neighbours.hpp"
#include "formats/transport/range_coder.hpp"

namespace greenloop::transport {

/// What the values of couplings are like: learned on one level and partner, of use on the next.
struct CouplingStatistics {
  CouplingStatistics();
  MixedInteger values;
};

/// Codes `begin` and `blocks` of `couplings`; what else it says both sides know. Whether a block is stored, in which
/// of at most layout::strengths layers, and its nine values are predicted from the blocks of neighbouring columns and
/// rows coded before. `columns` and `rows`: where the coefficients are, one point each. A decoder throws DamagedPacket
/// if it reads a value that does not fit in its layer. Work: columns times rows, and some hundred operations a value.
void code_couplings(BitCoder& coder, CouplingStatistics& statistics, CouplingBlocks& couplings,
                    std::span<const GridPoint> columns, std::span<const GridPoint> rows);

}  // namespace greenloop::transport
