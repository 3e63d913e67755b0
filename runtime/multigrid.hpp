#pragma once

#include <cstdint>
#include <span>

#include "runtime/loop.hpp"
#include "runtime/model.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct ElasticBody;  // what a body keeps in its arena: runtime/multigrid/elastic_body.hpp

/// An elastic body that moves, heterogeneous and by large rotations, stepped by Newmark's method (Georgii & Westermann
/// 2005). Each step solves M a + C v + f(u) = loads by Newton passes of conjugate gradients, preconditioned by
/// multigrid cycles of the body at rest that are turned with its vertices: as many as the budget holds. What a short
/// step leaves out of balance is not lost: the next one begins from the state that it came to.
class Multigrid {
 public:
  /// What a body must be able to do, fixed before the loop starts.
  struct Limits {
    std::uint32_t max_loads = 64;
    std::uint32_t max_holds = 64;
    float tolerance = 1.0e-4F;  ///< 1e-6..0.5, of the residual: a step ends when it is reached
  };

  /// What Limits cost.
  struct Requirement : greenloop::Requirement {
    std::uint64_t cycle_work = 0;   ///< units of a cycle more
    std::uint64_t shown_work = 0;   ///< of the displacements of all shown vertices
    std::uint64_t stress_work = 0;  ///< of the stress of all vertices
  };

  /// A force on a vertex, N.
  struct Load {
    std::uint32_t vertex = 0;
    Vec3 force{};
  };

  /// A vertex that is held at a displacement, m, in this step.
  struct Hold {
    std::uint32_t vertex = 0;
    Vec3 displacement{};
  };

  /// What acts in a step. Loads on one vertex add up.
  struct Inputs {
    std::span<const Load> loads{};
    std::span<const Hold> holds{};
    const Vec3* gravity = nullptr;  ///< m/s^2; null: the model's
  };

  /// What a step is asked for; the caller owns the memory. What is empty is not wanted.
  struct Response {
    std::span<Vec3> displacement{};  ///< [vertices, or `chosen`] m
    std::span<const std::uint32_t> chosen{};
    std::span<Vec3> reaction{};  ///< [holds] N, with which each hold acts on the body
    std::span<Vec3> shown{};     ///< [shown vertices] m, displacements of the surface that is shown
    std::span<float> stress{};   ///< [vertices] Pa, von Mises, mean of the tetrahedra around by volume
  };

  struct StepReport : greenloop::StepReport {
    float residual = 0;  ///< forces out of balance, relative to the largest of: those that the step began with, loads
                         ///< and weight, reactions; root sums of squares
    std::uint32_t cycles = 0;
    std::uint32_t passes = 0;  ///< of Newton
  };

  /// J, of the last step's state.
  struct Energy {
    float kinetic = 0, elastic = 0;
  };

  struct Created;

  /// Bytes and work for `limits`. Start-up; work: linear in the grids. Zero bytes if `create` would refuse for another
  /// reason than memory.
  [[nodiscard]] static Requirement required(const Model& model, const Limits& limits) noexcept;

  /// Carves `memory`; the model's bytes and `memory` must outlive the body, which begins at rest, undeformed. Start-up;
  /// work: linear in the model.
  [[nodiscard]] static Created create(const Model& model, const Limits& limits, std::span<std::byte> memory) noexcept;

  /// One cycle of the loop: a time step of the model. ok: the residual is within the tolerance; coarser: the budget
  /// ended before. Refused, and nothing moves or is written: numbers that are not finite (held_not_finite), vertices
  /// that there are not or more inputs than the limits allow (held_out_of_range), a hold of a vertex that the model
  /// holds (held_not_touchable), two of one vertex (held_duplicate), buffers of other sizes (held_response_size), a
  /// budget below what the answer takes with one cycle (held_over_budget), a state that is not finite or moved by more
  /// than twice the body's size in a step (held_overflow): then the body is stopped where it was. No heap, lock, system
  /// call, exception or clock; same model, limits, history and budget give the same bits. Work: at most budget.work.
  StepReport step(const Inputs& inputs, Budget budget, const Response& response) noexcept;

  /// For the loop; work: linear in the tetrahedra.
  [[nodiscard]] Energy energy() const noexcept;

 private:
  ElasticBody* body_ = nullptr;
};

struct Multigrid::Created : Creation {
  Multigrid body;
};

}  // namespace greenloop
