// Motions of a scene that was simulated, in C.
#include <bit>
#include <cstddef>
#include <type_traits>

#include "runtime/c_body_values.hpp"
#include "runtime/c_values.hpp"
#include "runtime/greenloop_impulse.h"
#include "runtime/impulse_response.hpp"

namespace greenloop {
namespace {

static_assert(sizeof(ImpulseResponse) == sizeof(void*) && std::is_trivially_copyable_v<ImpulseResponse>);
static_assert(ImpulseResponse::no_impulse == GREENLOOP_NO_IMPULSE);
static_assert(Light::coefficients == GREENLOOP_LIGHT_COEFFICIENTS && sizeof(Light) == sizeof(greenloop_light));

ImpulseResponse moving_in(const greenloop_impulse_response* body) {
  return std::bit_cast<ImpulseResponse>(reinterpret_cast<const MovingBody*>(body));
}

std::span<float> floats(float* first, std::uint32_t count) { return {first, first == nullptr ? 0 : count}; }

std::span<Vec3> vectors(float* first, std::uint32_t count) {
  return {reinterpret_cast<Vec3*>(first), first == nullptr ? 0 : count};
}

// null unless the model is one of impulse responses
const layout::ImpulseInfo* info_of(const greenloop_model* model) {
  return model_in(model).view().impulse_response.info;
}

}  // namespace

ImpulseResponse::Limits moving_limits_of(const greenloop_impulse_response_limits& limits) noexcept {
  return {limits.rate, limits.stretch == 0 ? 1.0F : limits.stretch, limits.blend_rate};
}

greenloop_impulse_response_report motion_report_of(const ImpulseResponse::StepReport& report) noexcept {
  return {static_cast<greenloop_status>(report.status),
          report.work,
          report.orbit,
          report.row,
          report.impulse,
          report.modes,
          report.planes,
          report.truncation_error,
          report.distance,
          report.blend,
          report.at_rest ? 1 : 0,
          report.transfer_modes,
          report.transfer_error};
}

}  // namespace greenloop

using namespace greenloop;

void greenloop_light_harmonics(const float direction[3], float* harmonics) {
  float value[Light::coefficients];
  light_harmonics({direction[0], direction[1], direction[2]}, value);
  for (std::size_t i = 0; i < Light::coefficients; ++i) harmonics[i] = value[i];
}

greenloop_light greenloop_light_rotated(const greenloop_light* light, const float rotation[9]) {
  float matrix[9];
  for (std::size_t i = 0; i < 9; ++i) matrix[i] = rotation[i];
  return std::bit_cast<greenloop_light>(rotated(std::bit_cast<Light>(*light), matrix));
}

uint32_t greenloop_impulse_response_modes(const greenloop_model* model) {
  return model_in(model).view().impulse_response.modes;
}

uint32_t greenloop_impulse_response_vertices(const greenloop_model* model) {
  const layout::ImpulseInfo* const info = info_of(model);
  return info == nullptr ? 0 : info->vertices;
}

uint32_t greenloop_impulse_response_impulses(const greenloop_model* model) {
  const layout::ImpulseInfo* const info = info_of(model);
  return info == nullptr ? 0 : info->impulses;
}

greenloop_impulse_response_requirement greenloop_impulse_response_required(const greenloop_model* model,
                                                                           greenloop_impulse_response_limits limits) {
  const ImpulseResponse::Requirement need = ImpulseResponse::required(model_in(model), moving_limits_of(limits));
  return {need.bytes, need.least_work, need.least_frame_work, need.frame_work, need.colour_work, need.worst_work};
}

greenloop_impulse_response_created greenloop_impulse_response_create(const greenloop_model* model,
                                                                     greenloop_impulse_response_limits limits,
                                                                     void* memory, size_t bytes) {
  const auto created =
      ImpulseResponse::create(model_in(model), moving_limits_of(limits), {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_create_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_impulse_response*>(std::bit_cast<MovingBody*>(created.body))};
}

int greenloop_impulse_response_may_follow(const greenloop_impulse_response* body, uint32_t impulse) {
  return moving_in(body).may_follow(impulse) ? 1 : 0;
}

greenloop_impulse_response_report greenloop_impulse_response_step(greenloop_impulse_response* body, uint32_t impulse,
                                                                  uint64_t work,
                                                                  greenloop_impulse_response_buffers buffers) {
  const ImpulseResponse::Response response = {floats(buffers.coordinate, buffers.modes),
                                              floats(buffers.velocity, buffers.modes),
                                              vectors(buffers.displacement, buffers.vertices),
                                              vectors(buffers.displacement_rate, buffers.vertices),
                                              {buffers.chosen, buffers.chosen == nullptr ? 0 : buffers.vertices},
                                              vectors(buffers.colour, buffers.vertices),
                                              reinterpret_cast<const Light*>(buffers.light)};
  const ImpulseResponse::StepReport report = moving_in(body).step(impulse, {work}, response);
  return motion_report_of(report);
}
