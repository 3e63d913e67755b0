#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/elastostatic/step_work.hpp"

namespace greenloop {

/// Sizes of a body's arrays and what bounds its work, from the model and the limits alone.
struct BodySizes {
  bool supported = false;  ///< limits in range, countable, and no point hanging on more than most_support nodes
  ModelCounts counts;
  std::uint32_t set_columns = 0;     ///< most columns of a contact set
  std::uint32_t longest_column = 0;  ///< most blocks in a column of a layer
  LiftingCounts lifting[layout::max_levels] = {};
  std::uint64_t functional = 0;  ///< most coefficients of a point functional
  std::uint64_t slots = 0;       ///< bound of the coefficients that a set's functionals have
};

/// Whether each limit is within the range that Limits states.
[[nodiscard]] bool in_range(const Elastostatic::Limits& limits) noexcept;

/// Start-up; work: that of bound_reach, bound_columns and add_blocks.
void measure_body(const ModelView& view, const Elastostatic::Limits& limits, BodySizes& sizes,
                  Elastostatic::Requirement& requirement) noexcept;

}  // namespace greenloop
