#pragma once

#include <cstdint>
#include <span>

#include "runtime/light.hpp"
#include "runtime/loop.hpp"
#include "runtime/model.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct MovingBody;  // what a body keeps in its arena: runtime/impulse_response/moving_body.hpp

/// Motions of a scene that was simulated, replayed by its impulse responses (James & Fatahalian 2003, section 5.2):
/// plays the orbit that the last impulse led to, goes over to another at the next impulse or at its end, and lets the
/// difference die out: x(t) = orbit(t) + (x_now - x_start) exp(-lambda t), for displacements, velocities and radiance
/// transfer alike.
class ImpulseResponse {
 public:
  static constexpr std::uint32_t no_impulse = 0xffffffff;

  /// What a body must be able to do, fixed before the loop starts.
  struct Limits {
    float rate = 0;        ///< Hz, steps per second; 0: the model's
    float stretch = 1;     ///< 1/64..64, model seconds per second of the loop: 0.5 plays at half the speed
    float blend_rate = 0;  ///< 1/s, lambda; 0: the model's
  };

  /// What Limits cost.
  struct Requirement : greenloop::Requirement {
    std::uint64_t least_frame_work = 0;  ///< units of a step with the displacement of all vertices by the fewest modes
    std::uint64_t frame_work = 0;        ///< the same by all modes
    std::uint64_t colour_work = 0;       ///< of the colours of all vertices by all modes; 0: the model has none
    std::uint64_t worst_work = 0;        ///< of a frame with velocities and colours too: no step takes more
  };

  /// What a step is asked for; the caller owns the memory. What is empty is not wanted.
  struct Response {
    std::span<float> coordinate{};        ///< [modes] m, q_u
    std::span<float> velocity{};          ///< [modes] m/s, q_v
    std::span<Vec3> displacement{};       ///< [vertices, or `chosen`] m, from the model's shape
    std::span<Vec3> displacement_rate{};  ///< likewise, m/s
    /// Vertices; empty: the first ones, as many as are displaced. One takes as much as 16 of the first ones, and all no
    /// more than Requirement::worst_work: of more than a sixteenth of the vertices fewer modes are summed, or it is
    /// held_over_budget, whatever the budget.
    std::span<const std::uint32_t> chosen{};
    /// [vertices, or `chosen`] radiance that leaves each vertex, red, green and blue, in the unit of the light:
    /// diffuse, with the shadows and the colours that its parts give one another. Models with an appearance have it.
    std::span<Vec3> colour{};
    const Light* light = nullptr;  ///< for `colour`
  };

  struct StepReport : greenloop::StepReport {
    std::uint32_t orbit = 0;             ///< that is played; 0: the scene at rest
    std::uint32_t row = 0;               ///< of the model: the state that was last passed
    std::uint32_t impulse = no_impulse;  ///< that began it
    std::uint32_t modes = 0;             ///< in displacement and displacement_rate
    std::uint32_t planes = 0;            ///< of the modes' values, in them
    float truncation_error = 0;          ///< of displacements by so many modes, relative, root mean square
    std::uint32_t transfer_modes = 0;    ///< in colours, beside the mean
    float transfer_error = 0;  ///< of transfers by so many modes, relative to their variation, root mean square
    float distance = 0;        ///< m, of the states between which this step's impulse or continuation led; 0: none did
    float blend = 0;           ///< m, what is left of such differences: Euclidean, of displacements
    bool at_rest = false;      ///< the orbit has come to its end and moves no more, but for `blend`
  };

  struct Created;

  /// Bytes and work for `limits`. Start-up; work: linear in the orbits. Zero bytes if `create` would refuse for another
  /// reason than memory.
  [[nodiscard]] static Requirement required(const Model& model, const Limits& limits) noexcept;

  /// Carves `memory`; the model's bytes and `memory` must outlive the body, which begins at rest. Refuses models of
  /// another problem, and limits by which a step would pass more than 64 of the model's states. Start-up; work: linear
  /// in the modes and the orbits.
  [[nodiscard]] static Created create(const Model& model, const Limits& limits, std::span<std::byte> memory) noexcept;

  /// One cycle of the loop: gives the scene an impulse of its palette, or none, lets a period pass and answers what
  /// moved. With less budget than all modes take, fewer are summed. Refused, and nothing moves or is written: an
  /// impulse that the palette does not have (held_out_of_range) or that may not follow the last one
  /// (held_illegal_impulse), buffers of other sizes, colours without a light or of a model without appearance
  /// (held_response_size), a vertex that there is not (held_out_of_range), a light that is not finite or beyond 2^64
  /// (held_not_finite), a budget below what the answer takes by the fewest modes (held_over_budget). No heap, lock,
  /// system call, exception or clock; same model, limits, history and budget give the same bits. Work: at most
  /// budget.work; a step without displacements and colours takes at most Requirement::least_work.
  StepReport step(std::uint32_t impulse, Budget budget, const Response& response) noexcept;

  /// Whether an impulse may follow the last one. For the loop; work: constant.
  [[nodiscard]] bool may_follow(std::uint32_t impulse) const noexcept;

 private:
  MovingBody* body_ = nullptr;
};

struct ImpulseResponse::Created : Creation {
  ImpulseResponse body;
};

}  // namespace greenloop
