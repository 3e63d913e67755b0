#pragma once

#include <cstdint>

#include "runtime/elastostatic.hpp"

namespace greenloop {

/// Instructions of the heaviest kind of step: a fresh body, all contacts spread over what can be touched, no limit of
/// work, the field of all nodes. Counted by trapping after each (sim_hw/guard/instruction_counter), microseconds an
/// instruction; -1 where that cannot be done. Throws std::runtime_error if no body can be created.
[[nodiscard]] std::int64_t instructions_of_heaviest_step(const Model& model, const Elastostatic::Limits& limits);

}  // namespace greenloop
