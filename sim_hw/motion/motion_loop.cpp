#include "sim_hw/motion/motion_loop.hpp"

#include <algorithm>
#include <bit>

namespace greenloop {

MotionLoop::MotionLoop(const Model& model, const ImpulseResponse& body, const MotionSetup& setup)
    : body_(body),
      setup_(setup),
      coordinate_(model.view().impulse_response.modes),
      velocity_(model.view().impulse_response.modes),
      displacement_(model.view().impulse_response.info->vertices) {}

void MotionLoop::cycle(const ImpulseState& state) noexcept {
  state_ = state;
  displays_ = state.cycle % setup_.field_every == 0;
  const auto impulse = static_cast<std::uint32_t>(state.impulse);  // -1 is no_impulse
  const std::span<Vec3> frame = displays_ ? std::span<Vec3>(displacement_) : std::span<Vec3>();
  report_ = body_.step(impulse, setup_.budget, {coordinate_, velocity_, frame, {}, {}});
  while (state.cycle == setup_.overrun_cycle && report_.work <= setup_.budget.work) {
    const std::uint64_t work = report_.work;
    report_ = body_.step(ImpulseResponse::no_impulse, setup_.budget, {coordinate_, velocity_, frame, {}, {}});
    report_.work += work;
  }
}

void MotionLoop::answer(MotionCommand& command) noexcept {
  const auto add = [&](float x) { digest_.add_word(std::bit_cast<std::uint32_t>(x)); };
  digest_.add_word(static_cast<std::uint64_t>(report_.status));
  std::for_each(coordinate_.begin(), coordinate_.end(), add);
  std::for_each(velocity_.begin(), velocity_.end(), add);
  for (std::size_t i = 0; i < displacement_.size() && displays_; ++i) {
    add(displacement_[i].x);
    add(displacement_[i].y);
    add(displacement_[i].z);
  }
  // a refused cycle leaves the scene where it was
  const bool moved = answered(report_.status);
  command = {.cycle = state_.cycle,
             .work = static_cast<std::int64_t>(report_.work),
             .budget = static_cast<std::int64_t>(setup_.budget.work),
             .status = static_cast<std::int32_t>(report_.status),
             .orbit = moved ? static_cast<std::int32_t>(report_.orbit) : command.orbit,
             .row = moved ? static_cast<std::int32_t>(report_.row) : command.row,
             .rank = static_cast<std::int32_t>(report_.modes),
             .digest = static_cast<std::int64_t>(digest_.value()),
             .num_modes = static_cast<std::uint32_t>(coordinate_.size())};
  std::copy(coordinate_.begin(), coordinate_.end(), command.coordinate);
}

}  // namespace greenloop
