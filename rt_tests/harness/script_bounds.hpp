#pragma once

#include <cstdint>

namespace greenloop {

/// How far a script goes, so that it meets everything that a body can and cannot do.
struct ScriptBounds {
  std::uint32_t contacts = 0;    ///< most that a step may have
  std::uint32_t sets = 0;        ///< of contacts that the body remembers
  std::uint64_t least_work = 0;  ///< units, the smallest budget that is accepted
  std::uint64_t worst_work = 0;  ///< units, the most that a step may take
};

}  // namespace greenloop
