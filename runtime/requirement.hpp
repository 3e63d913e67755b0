#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/plan.hpp"

namespace greenloop {

/// Sizes of a body's arrays and bounds of its work, from the model and the limits alone.
struct BodySizes {
  bool supported = false;  ///< limits in range, and every point interpolated from at most three nodes of each level
  ModelCounts counts;
  std::uint32_t set_columns = 0;                            ///< most columns of a contact set
  std::uint32_t level_columns = 0;                          ///< most columns of a constraint level
  std::uint32_t functional_bound[layout::max_levels] = {};  ///< longest point functional of each constraint level
  std::uint32_t longest_functional = 0;
  std::uint64_t lifting_records[layout::max_levels] = {};
};

/// Whether each limit is within the range that Limits states.
[[nodiscard]] bool in_range(const Limits& limits) noexcept;

/// Start-up; linear in nodes times levels.
[[nodiscard]] BodySizes measure_body(const ModelView& view, const Limits& limits) noexcept;

/// Work of the worst step per constraint level, and the least budget; bytes are left 0. Start-up.
[[nodiscard]] Requirement bound_work(const ModelView& view, const BodySizes& sizes) noexcept;

}  // namespace greenloop
