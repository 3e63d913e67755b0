#pragma once

#include <cstdint>
#include <vector>

#include "formats/view.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/compliance/mirrored_couplings.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop::offline {

/// What fields of a model are summed of.
struct FieldSize {
  std::uint64_t blocks = 0;   ///< of all coefficients: every coupling in both directions, and the diagonal
  std::uint64_t longest = 0;  ///< most blocks that a force on one touchable node of the finest level moves
};

/// Counts the blocks that a body of the loop sums for fields of the finest level.
class FieldCounter {
 public:
  /// `view` must outlive this. Work: that of making a body's tables.
  explicit FieldCounter(const ModelView& view);
  FieldCounter(const FieldCounter&) = delete;  // the refinement points into it
  FieldCounter& operator=(const FieldCounter&) = delete;

  /// By forces on some nodes, by their places in the domain, each once. Work: what they reach.
  [[nodiscard]] std::uint64_t blocks_of(std::vector<std::uint32_t> places);

  /// Over all coefficients.
  [[nodiscard]] std::uint64_t all_blocks() const;

 private:
  void carve(Arena& arena);

  const ModelView& view_;
  AlignedBytes memory_;
  RefinementTables tables_;
  MirroredCouplingsMaker<3> maker_;
  Touched touched_;
  Lifting lifting_;
  Refinement refinement_;
  std::vector<std::uint32_t> up_to_;
};

/// Work: FieldCounter's for every touchable node.
[[nodiscard]] FieldSize field_size(const ModelView& view);

}  // namespace greenloop::offline
