#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "rt_tests/harness/touching_checks.hpp"
#include "runtime/contact_body.hpp"

namespace greenloop {

/// A body that ran a script of tools, or why it did not.
struct TouchingRun : TouchCounts {
  const char* error = nullptr;  ///< null: it ran, and each cycle kept what is promised
  std::uint64_t cycle = 0;      ///< that the error is about, or how many there were
  std::size_t memory_bytes = 0;
  std::uint64_t digest = 0;  ///< of every report, force, torque, contact and displacement
  std::array<std::uint64_t, statuses> by_status{};
};

/// The digest of 200 cycles by TouchingScript on write_recorded_model's model of lifted Linear wavelets.
inline constexpr std::uint64_t touching_digest = 0x8b0580433a27eb0b;
inline constexpr std::uint32_t touching_cycles = 200;
inline constexpr std::uint32_t touching_contacts = 12;
inline constexpr std::uint32_t touching_iterations = 20;

/// Runs a script of tools, by its seed, on a model, and checks every cycle: work within the budget; forces that push
/// and lie in their cones; forces of tools that are the sums of their contacts'; finite numbers; refusals where
/// something is wrong and nowhere else; the last answer on a refusal. With `flip` one bit of one answer is changed, a
/// negative control.
[[nodiscard]] TouchingRun run_touching_script(const Model& model, const ContactBody::Limits& limits,
                                              std::span<std::byte> memory, std::uint64_t cycles, std::uint64_t seed,
                                              bool flip) noexcept;

}  // namespace greenloop
