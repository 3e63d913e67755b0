#pragma once

#include <cstdint>

#include "formats/write/impulse_response.hpp"

namespace greenloop {

/// What a synthetic impulse response model is like.
struct SyntheticMotion {
  std::uint32_t vertices = 100;  ///< of a strip
  std::uint32_t modes = 6;       ///< even
  std::uint32_t groups = 2;      ///< levels of the file; modes / 2 at most
  std::uint32_t planes = 1;
  std::uint32_t impulses = 3;
  std::uint32_t orbits = 9;          ///< beside the one at rest
  std::uint32_t rows = 24;           ///< of each of those
  bool alternating = false;          ///< whether no impulse may follow itself
  float time_step = 1.0F / 128;      ///< s
  float blend_rate = 16;             ///< 1/s
  std::uint32_t transfer_modes = 0;  ///< of its appearance; 0: it has none
};

/// A model of a strip whose modes swing and die out, as a damped string's do: each orbit begins in a state of another,
/// with a push of its impulse's sign. The same everywhere. For tests.
[[nodiscard]] ImpulseResponseData synthetic_motion(const SyntheticMotion& options);

}  // namespace greenloop
