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
    bool lit = false;                ///< their colours too, in this light
    Light light;
    std::uint32_t missing = 0;  ///< modes that the buffer of coordinates has no room for: to be refused
  };

  ImpulseScript(const Model& model, const ImpulseResponse::Requirement& need, std::uint64_t seed) noexcept;

  [[nodiscard]] Cycle next() noexcept;

 private:
  [[nodiscard]] std::uint32_t below(std::uint32_t bound) noexcept;
  void shine(Light& light) noexcept;

  std::uint32_t impulses_, vertices_;
  bool lit_;  // the model has an appearance
  ImpulseResponse::Requirement need_;
  std::uint64_t state_;
};

/// Where a run's answers stand; the sizes are those of the model.
struct ImpulseBuffers {
  std::span<float> coordinate;        ///< [modes]
  std::span<float> velocity;          ///< [modes]
  std::span<Vec3> displacement;       ///< [vertices + 1]
  std::span<Vec3> displacement_rate;  ///< [vertices + 1]
  std::span<Vec3> colour;             ///< [vertices + 1]
};

/// What a cycle asks a body for, in these buffers.
[[nodiscard]] ImpulseResponse::Response response_of(const ImpulseScript::Cycle& cycle, const ImpulseBuffers& buffers);

/// Whether a cycle may be refused: something is wrong with it, or its budget is below the worst case. legal: whether
/// its impulse could follow.
[[nodiscard]] bool may_be_refused(const ImpulseScript::Cycle& cycle, bool legal, const ImpulseResponseView& view,
                                  const ImpulseResponse::Requirement& need);

/// What is wrong with how a cycle was answered, null: nothing. Work is to be within budget and declaration, what was
/// asked for finite, and refused is what is wrong and nothing else.
[[nodiscard]] const char* what_is_wrong(const ImpulseScript::Cycle& cycle, const ImpulseResponse::StepReport& report,
                                        bool legal, const ImpulseResponseView& view,
                                        const ImpulseResponse::Requirement& need,
                                        const ImpulseResponse::Response& response);

/// m^2: |q_u|^2 + rho^2 |q_v|^2 of a state.
[[nodiscard]] double state_energy(const ImpulseResponseView& view, std::span<const float> coordinate,
                                  std::span<const float> velocity);

/// A body that ran a script of impulses, or why it did not.
struct ImpulseRun {
  const char* error = nullptr;  ///< null: it ran, and each cycle kept what is promised
  std::uint64_t cycle = 0;      ///< that the error is about, or how many there were
  std::size_t memory_bytes = 0;
  std::uint64_t digest = 0;  ///< of every report and buffer
  std::array<std::uint64_t, statuses> by_status{};
  std::uint64_t entered = 0;  ///< impulses that were followed
};

/// Runs the script by its seed on a model and checks every cycle (what_is_wrong), and that a refused one leaves the
/// last answer. With `flip` one bit of one answer is changed, a negative control.
[[nodiscard]] ImpulseRun run_impulse_script(const Model& model, const ImpulseResponse::Limits& limits,
                                            std::span<std::byte> memory, const ImpulseBuffers& buffers,
                                            std::uint64_t cycles, std::uint64_t seed, bool flip) noexcept;

/// The digest of so many cycles on write_recorded_model's motions.
inline constexpr std::uint64_t impulse_digest = 0x248853317e31545e;
inline constexpr std::uint32_t impulse_cycles = 2000;

}  // namespace greenloop
