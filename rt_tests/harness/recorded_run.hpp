#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "rt_tests/harness/driver.hpp"

namespace greenloop {

/// A body that ran the whole recorded script, or why it did not.
struct RecordedRun {
  const char* error = nullptr;  ///< null: it ran
  std::size_t arena_bytes = 0;
  std::uint64_t digest = 0;  ///< of every report, force and field
  AnswerCounts counts;

  /// Whether the script met all it is meant to meet on a model of that many levels.
  [[nodiscard]] bool complete(std::uint32_t model_levels) const noexcept;
};

/// The digests of the script by Elastostatic on write_recorded_model's models: what every target has to find.
inline constexpr std::uint64_t recorded_digest = 0x1b423bfa4783b0de;  ///< lifted Linear wavelets
inline constexpr std::uint64_t recorded_lifted_butterfly_digest = 0xd1ccbb50488aae1e;
inline constexpr std::uint64_t recorded_butterfly_digest = 0x91c8595b18eeb9c7;
inline constexpr std::uint64_t recorded_equilibrated_digest = 0xef5dc84ca20d4aa3;

/// Runs the script on the model file in `bytes`. field: 16-byte aligned, at least 4 floats per node. With `flip` one
/// bit of one answer is changed, a negative control.
template <Driver D>
[[nodiscard]] RecordedRun run_recorded_script(std::span<const std::byte> bytes, std::span<std::byte> arena,
                                              std::span<float> field, bool flip) noexcept;

}  // namespace greenloop
