#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/plan.hpp"

namespace greenloop {

/// Sizes of a body's arrays and what bounds its work, from the model and the limits alone.
struct BodySizes {
  bool supported = false;  ///< limits in range, and every point interpolated from at most three nodes of each level
  ModelCounts counts;
  std::uint32_t set_columns = 0;   ///< most columns of a contact set
  std::uint32_t longest_list = 0;  ///< most blocks in a column of a section
  std::uint32_t most_neighbours[layout::max_levels] = {};
  std::uint64_t lifting_records[layout::max_levels] = {};
  std::uint64_t functional = 0;  ///< most coefficients of a point functional
  Coefficients coefficients;
};

/// Whether each limit is within the range that Limits states.
[[nodiscard]] bool in_range(const Limits& limits) noexcept;

/// Start-up; linear in nodes times levels and, for every 1,024 rows of a section, in its blocks.
void measure_body(const ModelView& view, const Limits& limits, BodySizes& sizes, Requirement& requirement) noexcept;

}  // namespace greenloop
