#pragma once

#include <cstdint>
#include <span>

#include "runtime/contact_body.hpp"
#include "runtime/impulse_response.hpp"
#include "runtime/loop.hpp"
#include "runtime/model.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct VibratingParts;  // what a vibrating body keeps in its memory: runtime/vibrating_body.cpp

/// An elastic body that moves by impulse responses and is touched by rigid tools at once (docs/impulses.md, "Touched
/// while it moves"): an `ImpulseResponse` carries the surface of a `ContactBody`, and their displacements add, as those
/// of small motion do. Tools feel the moving surface; what they do to it is elastic and does not change its motion.
class VibratingBody {
 public:
  struct Limits {
    ContactBody::Limits contact{};  ///< it is carried whatever `carried` says
    ImpulseResponse::Limits motion{};
  };

  /// What Limits cost. A step that is given worst_work answers all modes and the finest level.
  struct Requirement : greenloop::Requirement {
    std::uint64_t worst_work = 0;
  };

  struct StepReport {
    ImpulseResponse::StepReport motion;  ///< refused: the surface stands still for this step
    ContactBody::StepReport contact;     ///< refused: the last answer stands, on a surface that has moved
    std::uint64_t work = 0;              ///< units spent by both, and by carrying the surface
  };

  struct Created;

  /// Bytes and work of both bodies: `touched` is an elastostatic model, `moving` one of impulse responses. Zero bytes
  /// if `create` would refuse for another reason than memory and models that do not match. Start-up.
  [[nodiscard]] static Requirement required(const Model& touched, const Model& moving, const Limits& limits) noexcept;

  /// Carves `memory` with the routine that `required` counts with. Refuses, besides what the two bodies refuse,
  /// mismatched_models: a node of `touched` has no vertex of `moving` at rest at its place, to 1e-3 of the diagonal of
  /// its bounding box; further vertices are allowed. The bytes of both models and `memory` must outlive the body.
  /// Start-up; work: n log n in the vertices.
  [[nodiscard]] static Created create(const Model& touched, const Model& moving, const Limits& limits,
                                      std::span<std::byte> memory) noexcept;

  /// One cycle of the loop: the impulse, or none, and a period of the motion; then the tools on the surface where that
  /// has brought it. Of the budget the contacts keep their least work; of the rest the motion takes as many modes as
  /// there are units for, and the contacts have what is then left. Below Requirement::least_work both are
  /// held_over_budget. No heap, lock, system call, exception or clock; the same models, limits, history and budget give
  /// the same bits. Work: at most budget.work.
  StepReport step(std::uint32_t impulse, std::span<const ContactBody::ToolInput> tools,
                  const Elastostatic::Loads& loads, Budget budget) noexcept;

  [[nodiscard]] ContactBody& contact() noexcept;  ///< for its answers; its steps and `carry` are this one's
  [[nodiscard]] const ImpulseResponse& motion() const noexcept;  ///< for `may_follow`
  /// [nodes] m, x y z 0, as of the last step: from rest, of the motion alone, and the sum of that and the contacts'.
  [[nodiscard]] std::span<const Vec4> offset() const noexcept;
  [[nodiscard]] std::span<const Vec4> displacement() const noexcept;

 private:
  VibratingParts* parts_ = nullptr;
};

struct VibratingBody::Created : Creation {
  VibratingBody body;
};

}  // namespace greenloop
