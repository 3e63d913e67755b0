#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "runtime/elastostatic.hpp"

namespace greenloop {

/// What came of running recorded steps again.
struct Replay {
  std::uint64_t first = 0;               ///< step it began with, counted from the recorder's creation
  std::uint64_t steps = 0;               ///< run, those that differ included
  std::optional<std::uint64_t> differs;  ///< the first step with another outcome; it was the last to be run
  bool unfinished = false;               ///< the record ends in a step that did not come back; here it did
};

/// Runs the record of a body that is still there again, in its own arena, which is then as after the last step. Throws
/// std::runtime_error if the bytes are no record or no checkpoint goes with the steps kept.
[[nodiscard]] Replay replay_in_place(std::span<const std::byte> record, Elastostatic& body);

/// Runs the record of another process again: maps the model and an arena at the addresses that they had there, makes a
/// body and puts the oldest usable checkpoint into it. `model`: the file's bytes. Throws std::runtime_error saying
/// why not: no record, another model, an address that is taken, another build of the library. Linux only.
[[nodiscard]] Replay replay(std::span<const std::byte> record, std::span<const std::byte> model);

}  // namespace greenloop
