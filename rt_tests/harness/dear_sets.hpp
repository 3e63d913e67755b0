#pragma once

#include <cstdint>
#include <vector>

#include "rt_tests/harness/driver.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// Contacts that take much work.
struct DearSet {
  std::vector<std::uint32_t> nodes;  ///< distinct, touchable
  std::uint64_t work = 0;            ///< units of a step that answers them afresh, whole field included
};

/// Hunts for the sets of contacts whose answers take the most work, one for each constraint level, coarsest first:
/// from the dearest nodes and from others at random, nodes are exchanged for others as long as the work rises. The
/// same model, limits and seed give the same sets. Throws std::runtime_error if there is no body for the limits.
template <Driver D>
[[nodiscard]] std::vector<DearSet> dear_sets(const Model& model, const typename D::Solver::Limits& limits,
                                             std::uint64_t seed);

}  // namespace greenloop
