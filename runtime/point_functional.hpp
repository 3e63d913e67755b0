#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/wavelet.hpp"

namespace greenloop {

/// One coefficient that a node's value depends on: the value is the sum of weight times coefficient.
struct PointCoefficient {
  std::uint32_t node;
  float weight;
};

/// The node values of a coarser level that a point's value is interpolated from: the corners of a triangle.
struct PointSupport {
  static constexpr std::uint32_t most = 3;

  std::uint32_t count = 0;
  std::uint32_t node[most];
  float weight[most];

  [[nodiscard]] float of(std::uint32_t wanted) const noexcept;
};

/// Replaces the nodes of M(level) in `support` by their domain parents. False if more than three nodes would be left,
/// which no subdivided triangulation does.
[[nodiscard]] bool coarsen(const ModelView& view, std::uint32_t level, PointSupport& support) noexcept;

/// e_node^T W^-1 as a list (selective reconstruction, James & Pai 2003, section 5.4), coarse coefficients last;
/// returns its length. `coefficient` has room for what point_functional_size says. For the loop; work: its length.
std::uint32_t point_functional(const ModelView& view, const Lifting& lifting, std::uint32_t node,
                               PointCoefficient* coefficient) noexcept;

/// A bound of point_functional's length at `node`, given LiftingCounts::most_neighbours of each level; 0 if coarsen
/// fails. Start-up; linear in the levels.
[[nodiscard]] std::uint32_t point_functional_bound(const ModelView& view, const std::uint32_t* most_neighbours,
                                                   std::uint32_t node) noexcept;

}  // namespace greenloop
