#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/memory/arena.hpp"

namespace greenloop {

/// Whether the caller's memory holds the bytes that `created` requests, where arrays may stand. What is available and
/// missing is filled in, and the error, `too_small` or `misaligned` of its own, if it does not. Start-up; constant
/// work.
template <class Created, class Error>
[[nodiscard]] bool memory_fits(std::span<std::byte> memory, Error too_small, Error misaligned,
                               Created& created) noexcept {
  created.available = memory.size();
  if (created.requested > memory.size()) {
    created.error = too_small;
    created.missing = created.requested - memory.size();
    return false;
  }
  if (reinterpret_cast<std::uintptr_t>(memory.data()) % Arena::alignment != 0) {
    created.error = misaligned;
    return false;
  }
  return true;
}

}  // namespace greenloop
