#pragma once

#include "runtime/hosted/hosted.hpp"
#include "sim_hw/control_loop/loop_body.hpp"

namespace greenloop {

/// A body of `Solver`, whose steps report levels, for the loop to drive.
template <class Solver>
class HostedLoopBody final : public LoopBody {
 public:
  /// `model` must outlive it. Throws std::runtime_error if it is refused, or the limits are.
  HostedLoopBody(const Model& model, const typename Solver::Limits& limits) : hosted_(model, limits) {}

  [[nodiscard]] LoopReport step(std::span<const Constraint> constraints, std::uint64_t work,
                                bool with_field) noexcept override {
    const auto report = hosted_.step(constraints, work, with_field);
    return {report.status, report.work, report.constraint_level, report.field_level};
  }
  [[nodiscard]] std::span<const float> force() const noexcept override { return hosted_.force(); }
  [[nodiscard]] std::span<const float> field() const noexcept override { return hosted_.field(); }

 private:
  Hosted<Solver> hosted_;
};

}  // namespace greenloop
