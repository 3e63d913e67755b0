#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/impulse_response.hpp"

namespace greenloop {

/// Random impulses on a body, legal and illegal ones, wrong buffers and budgets from refused to plenty: the same on
/// every target, made by integers alone, without heap.
class ImpulseScript {
 public:
  static constexpr std::uint32_t most_chosen = 5;

  struct Cycle {
    std::uint32_t impulse = ImpulseResponse::no_impulse;
    Budget budget;
    std::uint32_t vertices = 0;  ///< to be displaced; more than the model has: to be refused
    std::uint32_t chosen[most_chosen] = {};
    std::uint32_t chosen_count = 0;  ///< > 0: these instead
    bool rates = false;              ///< velocities of vertices too
  };

  ImpulseScript(const Model& model, const ImpulseResponse::Requirement& need, std::uint64_t seed) noexcept;

  [[nodiscard]] Cycle next() noexcept;

 private:
  [[nodiscard]] std::uint32_t below(std::uint32_t bound) noexcept;

  std::uint32_t impulses_, vertices_;
  ImpulseResponse::Requirement need_;
  std::uint64_t state_;
};

/// Where a run's answers stand; the sizes are those of the model.
struct ImpulseBuffers {
  std::span<float> coordinate;        ///< [modes]
  std::span<float> velocity;          ///< [modes]
  std::span<Vec3> displacement;       ///< [vertices + 1]
  std::span<Vec3> displacement_rate;  ///< [vertices + 1]
};

/// A body that ran a script of impulses, or why it did not.
struct ImpulseRun {
  const char* error = nullptr;  ///< null: it ran, and each cycle kept what is promised
  std::uint64_t cycle = 0;      ///< that the error is about, or how many there were
  std::size_t memory_bytes = 0;
  std::uint64_t digest = 0;  ///< of every report and buffer
  std::array<std::uint64_t, statuses> by_status{};
  std::uint64_t entered = 0;    ///< impulses that were followed
  std::uint64_t continued = 0;  ///< orbits that went on in others
  float most_blend = 0;         ///< m, largest difference that blending had to take out
  double most_energy = 0;       ///< m^2, largest |q_u|^2 + rho^2 |q_v|^2
};

/// Runs the script by its seed on a model and checks every cycle: work within the budget, finite numbers, refusals
/// where something is wrong and nowhere else, the last answer and motion on a refusal. With `flip` one bit of one
/// answer is changed, a negative control.
[[nodiscard]] ImpulseRun run_impulse_script(const Model& model, const ImpulseResponse::Limits& limits,
                                            std::span<std::byte> memory, const ImpulseBuffers& buffers,
                                            std::uint64_t cycles, std::uint64_t seed, bool flip) noexcept;

/// The digest of so many cycles on write_recorded_model's motions.
inline constexpr std::uint64_t impulse_digest = 0x14ed7b4b7ed27120;
inline constexpr std::uint32_t impulse_cycles = 2000;

}  // namespace greenloop
