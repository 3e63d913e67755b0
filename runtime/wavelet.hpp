#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/domain.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

// The lifted Linear wavelet transform of a field on the domain (James & Pai 2003, section 4; docs/theory.md).
// Level l of the mesh adds the odd nodes M(l), midpoints m of edges (a, b) of K(l-1). The inverse, for l = 1..L:
//   undo lifting   x_a -= lift[0] d_m,  x_b -= lift[1] d_m    for all m
//   predict        x_m  = d_m + (x_a + x_b) / 2               for all m
// in place on an array with one entry per node of the file; nodes outside the domain are 0 and stay so.

/// An odd node beside an even one, and the lifting weight between them.
struct OddNeighbour {
  std::uint32_t node;
  float lift;
};

/// The odd neighbours in M(l) of every domain node of K(l-1), in file order, for each level l: lifting as a gather.
struct OddNeighbours {
  const std::uint32_t* begin[layout::max_levels] = {};  ///< [l][domain nodes of K(l-1) + 1]
  const OddNeighbour* neighbour[layout::max_levels] = {};
};

/// Pairs of a domain node of M(level) and a domain parent of it: the entries of OddNeighbours. Start-up; linear.
[[nodiscard]] std::uint64_t lifting_pairs(const ModelView& view, std::uint32_t level) noexcept;

/// Largest number of odd neighbours that a domain node of K(level - 1) has in M(level). Start-up; linear in the level's
/// nodes for every 1,024 coarser ones.
[[nodiscard]] std::uint32_t most_odd_neighbours(const ModelView& view, std::uint32_t level) noexcept;

/// Fills begin[domain_up_to(level - 1) + 1] and neighbour[lifting_pairs(level)]. Start-up; linear.
void list_odd_neighbours(const ModelView& view, std::uint32_t level, std::uint32_t* begin,
                         OddNeighbour* neighbour) noexcept;

/// The inverse transform in place. Details of levels above `field_level` must be 0; there it only interpolates.
/// x: [node_count]. For the loop; work: inverse_transform_work.
void inverse_transform(const ModelView& view, const OddNeighbours& neighbours, std::uint32_t field_level,
                       Float4* x) noexcept;

/// Work units of inverse_transform: 3 per lifting pair up to field_level, 6 per domain node above level 0.
constexpr std::uint64_t inverse_transform_work(std::uint64_t lifting_pairs, std::uint64_t odd_nodes) {
  return 3 * lifting_pairs + 6 * odd_nodes;
}

}  // namespace greenloop
