#include "rt_tests/firmware/image/moving.hpp"

#include "rt_tests/firmware/image/instruction_clock.hpp"
#include "runtime/impulse_response.hpp"

namespace greenloop::firmware {
namespace {

constexpr std::uint32_t steps = 1000, steps_per_impulse = 40, frames = 60;
constexpr std::uint32_t most_modes = 16;

template <class Work>
std::uint32_t counted(Work work) {
  const std::uint64_t begin = instructions();
  work();
  return static_cast<std::uint32_t>(instructions() - begin);
}

}  // namespace

MovingTiming time_moving(std::span<const std::byte> model, std::span<std::byte> arena, std::span<float> field,
                         bool slow) {
  MovingTiming timing;
  const auto opened = Model::open(model);
  if (!opened || opened.model.problem() != layout::Problem::impulse_response) {
    return timing;
  }
  const ImpulseResponseView& view = opened.model.view().impulse_response;
  timing.modes = view.modes;
  timing.vertices = view.info->vertices;
  const std::size_t floats = std::size_t{3} * timing.vertices;
  const auto need = ImpulseResponse::required(opened.model, {.rate = 1000});
  auto created = ImpulseResponse::create(opened.model, {.rate = 1000}, arena);
  if (!created || timing.modes > most_modes || floats > field.size()) {
    return timing;
  }
  timing.state_work = need.least_work;
  timing.frame_work = need.frame_work;
  timing.ran = true;
  float coordinate[most_modes], velocity[most_modes];
  const ImpulseResponse::Response state = {{coordinate, timing.modes}, {velocity, timing.modes}, {}, {}};
  const ImpulseResponse::Response frame = {{}, {}, as_vec3(field.first(floats)), {}};
  const auto step = [&](std::uint32_t impulse, const ImpulseResponse::Response& response, std::uint32_t& worst) {
    const std::uint32_t taken = counted([&] {
      for (int repeated = slow ? 10 : 1; repeated > 0; --repeated) {
        timing.ran &= answered(created.body.step(impulse, {need.frame_work}, response).status);
        impulse = ImpulseResponse::no_impulse;
      }
    });
    worst = taken > worst ? taken : worst;
  };
  for (std::uint32_t i = 0; i < steps; ++i) {
    const std::uint32_t next = i / steps_per_impulse % view.info->impulses;
    const bool pushed = i % steps_per_impulse == 0 && created.body.may_follow(next);
    step(pushed ? next : ImpulseResponse::no_impulse, state, timing.state_worst);
  }
  for (std::uint32_t i = 0; i < frames; ++i) {
    step(ImpulseResponse::no_impulse, frame, timing.frame_worst);
  }
  return timing;
}

}  // namespace greenloop::firmware
