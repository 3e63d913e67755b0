#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/wavelet/prediction.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

/// What the columns of a constraint level cost at most, of those that touchable nodes are represented by.
struct ColumnBounds {
  std::uint32_t columns = 0;                       ///< that there are
  std::uint64_t reached[layout::max_levels] = {};  ///< coefficients of each level that all of them reach together
  // of one
  std::uint64_t all_coefficients = 0;             ///< that it reaches
  std::uint64_t visits = 0;                       ///< of touching those
  std::uint32_t forced[layout::max_levels] = {};  ///< odd nodes of each level that its force is shared among
  std::uint32_t even[layout::max_levels] = {};    ///< nodes of the next coarser level that it goes on to
  // summed over the dearest of a set
  std::uint64_t coefficients[layout::max_levels] = {};  ///< of each level
  std::uint64_t blocks = 0;                             ///< ColumnCost::blocks
};

/// Visits of listing the neighbours in M(level) of some even nodes.
constexpr std::uint64_t neighbour_visits(const LiftingCounts& lifting, std::uint64_t even) {
  constexpr std::uint32_t slots = OddNeighbours::most;
  return even * slots * ((lifting.most_neighbours + slots - 1) / slots);
}

/// Of sets of at most `set_columns` columns of level c; blocks are those with levels 0..c. lifting: of every level.
/// bound_reach must have bounded the level. Exact but for the blocks of coefficients after the first 640, for which
/// the largest count of their level stands, for those after the first 4,096, which count as reached, and for lifted
/// wavelets, whose neighbours are not listed here: as many of the most blocks stand for them. Start-up;
/// linear in the level's nodes times levels, and in the blocks.
[[nodiscard]] ColumnBounds bound_columns(const ModelView& view, std::uint32_t c, std::uint32_t set_columns,
                                         const LiftingCounts* lifting) noexcept;

}  // namespace greenloop
