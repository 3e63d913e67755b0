#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

/// Which coefficients the forces on some columns reach.
struct Touched {
  std::uint32_t finest = 0;                       ///< constraint level of a column
  std::uint64_t visits = 0;                       ///< steps of the transform
  std::uint32_t count[layout::max_levels] = {};   ///< coefficients of each level
  std::uint32_t* list[layout::max_levels] = {};   ///< those coefficients
  std::uint32_t forced[layout::max_levels] = {};  ///< nodes of M(l) with a force of level l, first in the list
  std::uint32_t even[layout::max_levels][layout::max_levels] = {};  ///< [l][q] nodes of M(q) with a force of level l-1
  bool* mark = nullptr;                                             ///< [domain], false between uses

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, const ModelView& view) noexcept;

  /// Coefficients over all levels.
  [[nodiscard]] std::uint64_t coefficients() const noexcept;
};

/// Finds the coefficients that forces on some columns reach: one of level c passes the levels c..1 of the transform.
/// column: [count], of distinct places, coarser ones first. `touched` must be clear. For the loop; work: 2 units per
/// visit.
void touch(const Refinement& refinement, const std::uint32_t* column, std::uint32_t count, Touched& touched) noexcept;

/// Forgets them. For the loop; work: one unit per coefficient.
void clear(Touched& touched) noexcept;

}  // namespace greenloop
