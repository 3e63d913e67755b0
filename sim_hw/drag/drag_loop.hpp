#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/algebra/fnv1a.hpp"
#include "runtime/multigrid.hpp"
#include "sim_hw/messages/drag_command.hpp"
#include "sim_hw/messages/drag_state.hpp"

namespace greenloop {

struct DragSetup {
  Budget budget;                    ///< of every cycle, as Multigrid::step has it
  std::int64_t field_every = 1;     ///< the shown surface is displaced in every so-manieth cycle
  std::int64_t overrun_cycle = -1;  ///< negative control: this cycle spends more than its budget; -1: none does
};

/// The loop proper of a soft body that a tool drags: one time step between the tool's newest state and the command that
/// answers it. cycle() and answer() use no heap, lock, system call, exception or clock.
class DragLoop {
 public:
  using State = DragState;
  using Command = DragCommand;

  /// `model` must outlive the loop. Takes the memory of its answers.
  DragLoop(const Model& model, const Multigrid& body, const DragSetup& setup);

  /// A time step; the vertex that the tool took hold of follows its travel from where it was then.
  void cycle(const DragState& state) noexcept;

  /// Writes the answer to the last cycle and adds its response to the digest.
  void answer(DragCommand& command) noexcept;

  [[nodiscard]] const DragState& state() const noexcept { return state_; }
  [[nodiscard]] Budget budget() const noexcept { return setup_.budget; }
  [[nodiscard]] const Multigrid::StepReport& report() const noexcept { return report_; }
  [[nodiscard]] Multigrid::Energy energy() const noexcept { return body_.energy(); }
  /// Whether the last cycle was to displace the shown surface.
  [[nodiscard]] bool displays() const noexcept { return displays_; }
  [[nodiscard]] const Multigrid::Hold& hold() const noexcept { return hold_; }  ///< where state().vertex >= 0
  [[nodiscard]] const Vec3& force() const noexcept { return force_; }           ///< N, of the tool
  [[nodiscard]] std::span<const Vec3> displacement() const noexcept { return displacement_; }  ///< m, of all vertices
  [[nodiscard]] std::span<const Vec3> shown() const noexcept { return shown_; }                ///< m, last shown

 private:
  Multigrid body_;
  DragSetup setup_;
  DragState state_;
  std::int32_t held_ = -1;  // in the last cycle
  Vec3 grip_{};             // m, displacement where it was taken hold of
  Multigrid::Hold hold_;
  Vec3 force_{};
  Multigrid::StepReport report_;
  bool displays_ = false;
  std::vector<Vec3> displacement_, shown_;
  Fnv1a digest_;
};

}  // namespace greenloop
