#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/block_predictions.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/prediction.hpp"

namespace greenloop {

// The wavelet transforms of a field on the domain (James & Pai 2003, section 4; docs/theory.md).
// Level l of the mesh adds the odd nodes M(l), midpoints m of edges (a, b) of K(l-1). The inverse, for l = 1..L:
//   undo lifting   x_a -= lift[0] d_m,  x_b -= lift[1] d_m    for all m
//   predict        x_m  = d_m + (x_a + x_b) / 2               for all m
//                  x_m += (x_c + x_d) / 8 - (x_e + x_f + x_g + x_h) / 16    for m with a Butterfly stencil
//   or instead     x_m  = d_m + (sum of P_mk x_k)             for all m, with blocks P_mk of the file
// Nodes outside the domain are 0.

/// Up to six odd neighbours in M(l) that are lifted into one domain node of K(l-1), in file order: lifting as a gather
/// in fixed steps. Nodes with more (irregular ones) have several in a row. Unused places weigh nothing.
struct alignas(64) OddNeighbours {
  static constexpr std::uint32_t most = 6;  ///< neighbours of a regular node

  std::uint32_t even;
  std::uint32_t count;
  std::uint32_t node[most];
  float lift[most];
};

/// The lifting of every level l > 0: its odd neighbours by domain node of K(l-1).
struct Lifting {
  const std::uint32_t* begin[layout::max_levels] = {};  ///< [l][domain nodes of K(l-1) + 1] into neighbours[l]
  const OddNeighbours* neighbours[layout::max_levels] = {};
};

/// Counts of one level's lifting.
struct LiftingCounts {
  std::uint32_t records = 0;          ///< OddNeighbours
  std::uint32_t most_neighbours = 0;  ///< of one node
};

/// Start-up; linear in the level's nodes for every 1,024 coarser ones.
[[nodiscard]] LiftingCounts count_lifting(const ModelView& view, std::uint32_t level) noexcept;

/// Fills begin[domain_up_to(level - 1) + 1] and neighbours[LiftingCounts::records]. Start-up; linear.
void list_odd_neighbours(const ModelView& view, std::uint32_t level, std::uint32_t* begin,
                         OddNeighbours* neighbours) noexcept;

/// Where the parents of a node stand in an array of Vector<N> per node.
struct ParentOffsets {
  std::uint32_t byte_offset[2];
};

/// Where what predicts a node stands in an array of Vector<N> per node.
template <unsigned N>
struct PredictionOffsets {
  ParentOffsets* parents = nullptr;  ///< [domain]; null with block predictions
  std::uint32_t* sources = nullptr;  ///< [terms of Predictions(1), of (2) and so on] byte offsets; null with others
  PredictBlocks<N> predict_blocks = greenloop::predict_blocks<N>;

  /// Out of `arena`; null while it counts. Start-up.
  void carve(Arena& arena, const ModelView& view) noexcept;

  /// Fills them in and chooses the fastest prediction. Start-up; linear.
  void fill(const ModelView& view) noexcept;
};

/// What a field is asked for.
struct FieldLevels {
  std::uint32_t nodes = 0;    ///< finest level whose nodes are displaced
  std::uint32_t details = 0;  ///< finest level whose details are summed, at most `nodes`
};

/// The inverse transform: displacements x of the nodes of K(levels.nodes), all of which are written. Levels above
/// levels.details are interpolated; their coefficients are not looked at. coefficients: [domain], those of levels
/// 0..levels.details are zero afterwards. For the loop; work: inverse_transform_work.
template <unsigned N>
void inverse_transform(const ModelView& view, const PredictionOffsets<N>& offsets, const FieldLevels& levels,
                       Vector<N>* coefficients, Vector<N>* x) noexcept;

/// Work units of inverse_transform. odd_nodes: of the domain above level 0; details: coefficients of levels up to
/// levels.details.
constexpr std::uint64_t inverse_transform_work(std::uint64_t nodes, std::uint64_t odd_nodes, std::uint64_t details,
                                               const Prices& prices, const Prediction& prediction) {
  return priced(nodes, prices.node) + priced(odd_nodes, node_price(prices, prediction)) +
         priced(details, prices.detail);
}

}  // namespace greenloop
