#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/stored_blocks.hpp"
#include "formats/view.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/prediction.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

/// The parents of every domain node by their place; layout::none outside the domain and on level 0.
struct DomainParents {
  std::uint32_t place[2];
};

/// The Butterfly stencil of every domain node by their place: two of wing_weight, four of outer_weight; layout::none
/// outside the domain and where prediction is linear.
struct DomainStencil {
  std::uint32_t place[6];
};

/// What the transform looks up, by place.
struct Refinement {
  const ModelView* view = nullptr;
  const Lifting* lifting = nullptr;
  Prediction prediction{};
  const DomainParents* parents = nullptr;   ///< [domain]; null with block predictions
  const DomainStencil* stencils = nullptr;  ///< [domain]; null without Butterfly wavelets
  const std::uint8_t* level = nullptr;      ///< [domain] mesh level
};

/// The arrays of a Refinement.
class RefinementTables {
 public:
  /// Out of `arena`; null while it counts. Start-up; work: that of count_lifting.
  void carve(Arena& arena, const ModelView& view) noexcept;

  /// Fills them in. Start-up; linear in the domain.
  void fill(const ModelView& view) noexcept;

  /// What they hold; `lifting` is filled in and referred to.
  [[nodiscard]] Refinement refinement(const ModelView& view, Lifting& lifting) const noexcept;

 private:
  std::uint32_t* begin_[layout::max_levels] = {};
  OddNeighbours* neighbours_[layout::max_levels] = {};
  DomainParents* parents_ = nullptr;
  DomainStencil* stencils_ = nullptr;
  std::uint8_t* level_ = nullptr;
};

/// Calls visit(place, stored block) for what predicts an odd node, with block predictions. Work: a visit a term.
template <class Visit>
[[gnu::always_inline]] inline void visit_blocks(const Refinement& refinement, std::uint32_t odd, Visit visit) {
  const LevelView& at = refinement.view->level[refinement.level[odd]];
  const std::uint32_t terms = at.predictions.terms;
  const std::size_t first = std::size_t{terms} * (odd - at.domain_begin);
  for (std::size_t term = first; term < first + terms; ++term) {
    visit(stored_source(at.predictions, term), at.predictions.weight + refinement.prediction.block_bytes * term);
  }
}

/// Calls visit(place, weight) for what predicts an odd node, with numbers as weights. Work: a visit a term.
template <class Visit>
[[gnu::always_inline]] inline void visit_numbers(const Refinement& refinement, std::uint32_t odd, Visit visit) {
  for (const std::uint32_t parent : refinement.parents[odd].place) {
    if (parent != layout::none) {
      visit(parent, 0.5F);
    }
  }
  for (std::uint32_t k = 0; refinement.stencils != nullptr && k < 6; ++k) {
    if (refinement.stencils[odd].place[k] != layout::none) {
      visit(refinement.stencils[odd].place[k], k < 2 ? layout::wing_weight : layout::outer_weight);
    }
  }
}

/// Calls visit(place, stored block or weight) for what predicts an odd node.
template <class Visit>
[[gnu::always_inline]] inline void visit_prediction(const Refinement& refinement, std::uint32_t odd, Visit visit) {
  if (refinement.prediction.blocks) {
    visit_blocks(refinement, odd, visit);
  } else {
    visit_numbers(refinement, odd, visit);
  }
}

/// Calls visit(place of the odd neighbour, lift) for the neighbours in M(level) of an even node.
template <class Visit>
void visit_neighbours(const Refinement& refinement, std::uint32_t level, std::uint32_t even, Visit visit) {
  const LevelView& at = refinement.view->level[level];
  const std::uint32_t* begin = refinement.lifting->begin[level] + even;
  for (std::uint32_t n = begin[0]; n < begin[1]; ++n) {
    const OddNeighbours& record = refinement.lifting->neighbours[level][n];
    for (std::uint32_t k = 0; k < record.count; ++k) {
      visit(record.node[k] - at.node_begin + at.domain_begin, record.lift[k]);
    }
  }
}

}  // namespace greenloop
