#pragma once

#include <cstdint>

#include "formats/view.hpp"

namespace greenloop {

/// The nodes of a coarser level that a node's value is interpolated from, and that a force on it is shared among: the
/// corners of a triangle.
struct PointSupport {
  static constexpr std::uint32_t most = 3;

  std::uint32_t count = 0;
  std::uint32_t node[most];
};

/// Replaces the nodes of M(level) in `support` by their domain parents. False if more than three nodes would be left,
/// which no subdivided triangulation does.
[[nodiscard]] bool coarsen(const ModelView& view, std::uint32_t level, PointSupport& support) noexcept;

/// Most coefficients that a force on one node of K(c) reaches.
struct ReachBound {
  bool bounded = false;  ///< no node of K(c) hangs on more than three nodes of a coarser level
  std::uint64_t visits = 0;
  std::uint32_t coefficients[layout::max_levels] = {};  ///< of each level
};

/// most_neighbours, of every level: LiftingCounts::most_neighbours. Start-up; linear in domain nodes times levels.
[[nodiscard]] ReachBound bound_reach(const ModelView& view, std::uint32_t c,
                                     const std::uint32_t* most_neighbours) noexcept;

}  // namespace greenloop
