#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/prediction.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

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
  const std::byte** block = nullptr;  ///< [2 slots] a step's first stored block, or null; null without predictions
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

}  // namespace greenloop
