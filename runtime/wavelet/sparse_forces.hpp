#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/float4.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/prediction.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

// The transform of sparse nodal forces into wavelet coefficients, T_l^-T for l = c..1 (docs/theory.md):
//   g_a = f_a + (sum of w^T f_m over the odd m that a predicts with weight w),
//   e_m = f_m - (sum of lift(m -> a) g_a over parents a),
// in place, by place in the domain, since the places of K(l-1) come before those of M(l). With a unit force at one node
// it gives the weights with which that node's displacement depends on every coefficient.

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

/// Forces on columns.
struct ColumnForces {
  std::uint32_t count;
  const std::uint32_t* column;  ///< [count] of distinct places, coarser ones first
  const float* force;           ///< [3 * count] N; denormal numbers count as 0
};

/// The force coefficients T^-T f of forces on columns, each of which enters on its own level. touched: by the same
/// columns; force: [domain], 0 before. For the loop; work: Prediction::force_work per visit.
void transform_forces(const Refinement& refinement, const ColumnForces& columns, const Touched& touched,
                      Float4* force) noexcept;

/// The inverse transform of coefficients that forces reach, which is the adjoint of transform_forces, as steps in
/// order: x[target] += the sum of weight x[source] over its terms. Targets and sources are slots of coefficients. Where
/// a step has blocks, as block predictions have and copies have not, each weight is times one of them, in their order.
struct SparseInverse {
  struct Step {
    std::uint32_t target;
    std::uint32_t end;  ///< of its terms, which begin where those of the step before end
  };
  struct Term {
    std::uint32_t source;
    float weight;
  };

  Step* step = nullptr;  ///< [4 slots], with blocks [2 slots]
  Term* term = nullptr;  ///< [slots (Prediction::length + 3)], with blocks [slots (length + 1)]
  std::uint32_t steps = 0;
  std::uint32_t* settled = nullptr;   ///< [slots] steps after which a slot holds the value of its node
  const std::byte** block = nullptr;  ///< [2 slots] stored_block of a step's first, or null; null without predictions
                                      ///< by blocks

  /// Arrays out of `arena` for so many slots; null while it counts.
  void carve(Arena& arena, std::uint64_t slots, const Prediction& prediction) noexcept;
};

/// Columns, and the slots that hold the values of their nodes, on the columns' own levels, in the end.
struct InverseAnswers {
  std::uint32_t count;
  const std::uint32_t* column;  ///< [count]
  const std::uint32_t* slot;    ///< [count] of a column of the finest level its coefficient's
};

/// Lists the steps for touched coefficients. slot: [domain] theirs. For the loop; work: 2 units per visit.
void list_inverse(const Refinement& refinement, const Touched& touched, const std::uint32_t* slot,
                  const InverseAnswers& answers, SparseInverse& inverse) noexcept;

/// Zeroes the touched coefficients. For the loop; work: one unit per coefficient.
void clear_forces(const Touched& touched, Float4* force) noexcept;

}  // namespace greenloop
