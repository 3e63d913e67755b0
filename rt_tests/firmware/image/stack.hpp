#pragma once

#include <cstddef>

namespace greenloop::firmware {

/// Fills the stack below the caller with a pattern.
void paint_stack();

/// Bytes of the stack that were written to since paint_stack.
[[nodiscard]] std::size_t deepest_stack();

}  // namespace greenloop::firmware
