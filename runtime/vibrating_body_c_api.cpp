// Bodies that move and are touched at once, in C.
#include <bit>
#include <cstddef>
#include <type_traits>

#include "runtime/c_body_values.hpp"
#include "runtime/c_values.hpp"
#include "runtime/greenloop_vibrating.h"
#include "runtime/vibrating_body.hpp"

namespace greenloop {
namespace {

static_assert(sizeof(VibratingBody) == sizeof(void*) && std::is_trivially_copyable_v<VibratingBody>);

VibratingBody vibrating_in(const greenloop_vibrating_body* body) {
  return std::bit_cast<VibratingBody>(reinterpret_cast<const VibratingParts*>(body));
}

VibratingBody::Limits vibrating_limits_of(const greenloop_vibrating_body_limits& limits) {
  return {touched_limits_of(limits.contact), moving_limits_of(limits.motion)};
}

const float* floats_of(std::span<const Vec4> field, std::size_t* nodes) {
  *nodes = field.size();
  return reinterpret_cast<const float*>(field.data());
}

}  // namespace
}  // namespace greenloop

using namespace greenloop;

greenloop_vibrating_body_requirement greenloop_vibrating_body_required(const greenloop_model* touched,
                                                                       const greenloop_model* moving,
                                                                       greenloop_vibrating_body_limits limits) {
  const auto need = VibratingBody::required(model_in(touched), model_in(moving), vibrating_limits_of(limits));
  return {need.bytes, need.least_work, need.worst_work};
}

greenloop_vibrating_body_created greenloop_vibrating_body_create(const greenloop_model* touched,
                                                                 const greenloop_model* moving,
                                                                 greenloop_vibrating_body_limits limits, void* memory,
                                                                 size_t bytes) {
  const auto created = VibratingBody::create(model_in(touched), model_in(moving), vibrating_limits_of(limits),
                                             {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_create_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_vibrating_body*>(std::bit_cast<VibratingParts*>(created.body))};
}

greenloop_vibrating_body_report greenloop_vibrating_body_step(greenloop_vibrating_body* body, uint32_t impulse,
                                                              const greenloop_tool* tools, size_t count,
                                                              const greenloop_loads* loads, uint64_t work) {
  const VibratingBody::StepReport report =
      vibrating_in(body).step(impulse, Tools(tools, count).all(), acting(loads), {work});
  return {motion_report_of(report.motion), touch_report_of(report.contact), report.work};
}

greenloop_contact_body* greenloop_vibrating_body_contact(const greenloop_vibrating_body* body) {
  return reinterpret_cast<greenloop_contact_body*>(std::bit_cast<TouchedBody*>(vibrating_in(body).contact()));
}

int greenloop_vibrating_body_may_follow(const greenloop_vibrating_body* body, uint32_t impulse) {
  return vibrating_in(body).motion().may_follow(impulse) ? 1 : 0;
}

const float* greenloop_vibrating_body_offset(const greenloop_vibrating_body* body, size_t* nodes) {
  return floats_of(vibrating_in(body).offset(), nodes);
}

const float* greenloop_vibrating_body_displacement(const greenloop_vibrating_body* body, size_t* nodes) {
  return floats_of(vibrating_in(body).displacement(), nodes);
}
