#pragma once

#include <cstdint>

#include "rt_tests/harness/driver.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// Instructions of the heaviest kind of step: a fresh body, all contacts spread over what can be touched, no limit of
/// work, the field of all nodes. Counted by trapping after each (sim_hw/guard/instruction_counter), microseconds an
/// instruction; -1 where that cannot be done. Throws std::runtime_error if no body can be created.
template <Driver D>
[[nodiscard]] std::int64_t instructions_of_heaviest_step(const Model& model, std::uint32_t contacts,
                                                         std::uint32_t factors);

}  // namespace greenloop
