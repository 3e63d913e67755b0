#pragma once

#include <cstddef>
#include <span>

#include "formats/view.hpp"

namespace greenloop {

/// Reads everything a runtime may read through the view of an accepted file, as it would: false if a pointer leaves
/// the file or an index its range. Work: linear in the file.
[[nodiscard]] bool walk_view(std::span<const std::byte> file, const ModelView& view);

/// What the fuzzer and the mutation test do with an input: verifies it as it is, then again with length and checksums
/// mended, so that the deeper rules are reached, and walks the view of whatever is accepted.
struct InputOutcome {
  bool accepted = false;  ///< once mended
  int rule = 0;           ///< VerifyRule that refused the mended input
};

/// Aborts if an accepted view is not sound, or a refused one is not empty.
InputOutcome try_input(std::span<const std::byte> input);

}  // namespace greenloop
