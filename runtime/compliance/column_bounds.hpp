#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/wavelet/prediction.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

/// What the columns of a constraint level cost at most, of those that touchable nodes are represented by.
struct ColumnBounds {
  std::uint32_t columns = 0;                       ///< that there are
  std::uint64_t touched[layout::max_levels] = {};  ///< coefficients of each level that a set reaches
  std::uint64_t meetings = 0;                      ///< ColumnSums::meetings of a set
  // of one
  std::uint64_t all_coefficients = 0;             ///< that it reaches
  std::uint64_t visits = 0;                       ///< of touching those
  std::uint32_t forced[layout::max_levels] = {};  ///< odd nodes of each level that its force is shared among
  std::uint32_t even[layout::max_levels] = {};    ///< nodes of the next coarser level that it goes on to
};

/// Visits of listing the neighbours in M(level) of some even nodes.
constexpr std::uint64_t neighbour_visits(const LiftingCounts& lifting, std::uint64_t even) {
  constexpr std::uint32_t slots = OddNeighbours::most;
  return even * slots * ((lifting.most_neighbours + slots - 1) / slots);
}

/// Of sets of at most `set_columns` columns of level c. lifting: of every level. bound_reach must have bounded the
/// level. The largest of exact counts, but for the blocks of coefficients that Degrees does not count each, for
/// coefficients after the first 4,096, which count as reached, and for lifted ones that `follow` does not list.
/// Start-up; work: that of fill_degrees, and that of `follow` for every ReachBatch of columns, twice.
[[nodiscard]] ColumnBounds bound_columns(const ModelView& view, std::uint32_t c, std::uint32_t set_columns,
                                         const LiftingCounts* lifting) noexcept;

}  // namespace greenloop
