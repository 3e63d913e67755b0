#include "sim_hw/drag/drag_loop.hpp"

#include <bit>

namespace greenloop {

DragLoop::DragLoop(const Model& model, const Multigrid& body, const DragSetup& setup)
    : body_(body),
      setup_(setup),
      displacement_(model.view().multigrid.info->vertices),
      shown_(model.view().multigrid.info->shown) {}

void DragLoop::cycle(const DragState& state) noexcept {
  state_ = state;
  displays_ = state.cycle % setup_.field_every == 0;
  const bool holds = state.vertex >= 0;
  if (holds) {
    const auto vertex = static_cast<std::uint32_t>(state.vertex);
    if (state.vertex != held_ && vertex < displacement_.size()) grip_ = displacement_[vertex];
    hold_ = {vertex,
             {grip_.x + static_cast<float>(state.travel[0]), grip_.y + static_cast<float>(state.travel[1]),
              grip_.z + static_cast<float>(state.travel[2])}};
  }
  held_ = state.vertex;
  force_ = {};
  const std::size_t count = holds ? 1 : 0;
  const Multigrid::Inputs inputs{.holds = {&hold_, count}};
  const Multigrid::Response response{.displacement = displacement_,
                                     .reaction = {&force_, count},
                                     .shown = displays_ ? std::span<Vec3>(shown_) : std::span<Vec3>()};
  report_ = body_.step(inputs, setup_.budget, response);
  while (state.cycle == setup_.overrun_cycle && answered(report_.status) && report_.work <= setup_.budget.work) {
    const std::uint64_t work = report_.work;
    report_ = body_.step(inputs, setup_.budget, response);
    report_.work += work;
  }
}

void DragLoop::answer(DragCommand& command) noexcept {
  const auto add = [&](const Vec3& v) {
    for (const float x : {v.x, v.y, v.z}) digest_.add_word(std::bit_cast<std::uint32_t>(x));
  };
  digest_.add_word(static_cast<std::uint64_t>(report_.status));
  add(force_);
  for (const Vec3& v : displacement_) add(v);
  for (std::size_t i = 0; i < shown_.size() && displays_; ++i) add(shown_[i]);
  command = {.cycle = state_.cycle,
             .work = static_cast<std::int64_t>(report_.work),
             .budget = static_cast<std::int64_t>(setup_.budget.work),
             .status = static_cast<std::int32_t>(report_.status),
             .cycles = static_cast<std::int32_t>(report_.cycles),
             .residual = report_.residual,
             .force = {force_.x, force_.y, force_.z},
             .digest = static_cast<std::int64_t>(digest_.value())};
}

}  // namespace greenloop
