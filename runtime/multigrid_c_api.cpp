// Elastic bodies that move, in C.
#include <bit>
#include <cstddef>
#include <type_traits>

#include "runtime/c_values.hpp"
#include "runtime/greenloop_multigrid.h"
#include "runtime/multigrid.hpp"
#include "runtime/multigrid/elastic_body.hpp"

namespace greenloop {
namespace {

static_assert(sizeof(Multigrid) == sizeof(void*) && std::is_trivially_copyable_v<Multigrid>);
static_assert(sizeof(Multigrid::Load) == sizeof(greenloop_multigrid_load) &&
              offsetof(Multigrid::Load, force) == offsetof(greenloop_multigrid_load, force));
static_assert(sizeof(Multigrid::Hold) == sizeof(greenloop_multigrid_hold) &&
              offsetof(Multigrid::Hold, displacement) == offsetof(greenloop_multigrid_hold, displacement));
static_assert(StepReport::no_constraint == GREENLOOP_NO_CONSTRAINT);

Multigrid elastic_in(const greenloop_multigrid* body) {
  return std::bit_cast<Multigrid>(reinterpret_cast<const ElasticBody*>(body));
}

Multigrid::Limits elastic_limits_of(const greenloop_multigrid_limits& limits) {
  return {limits.max_loads, limits.max_holds, limits.tolerance == 0 ? Multigrid::Limits{}.tolerance : limits.tolerance};
}

// null unless the model is a multigrid one
const layout::MultigridInfo* elastic_info_of(const greenloop_model* model) {
  return model_in(model).view().multigrid.info;
}

std::span<Vec3> vectors(float* first, std::size_t count) {
  return {reinterpret_cast<Vec3*>(first), first == nullptr ? 0 : count};
}

}  // namespace
}  // namespace greenloop

using namespace greenloop;

uint32_t greenloop_multigrid_vertices(const greenloop_model* model) {
  const layout::MultigridInfo* const info = elastic_info_of(model);
  return info == nullptr ? 0 : info->vertices;
}

uint32_t greenloop_multigrid_shown_vertices(const greenloop_model* model) {
  const layout::MultigridInfo* const info = elastic_info_of(model);
  return info == nullptr ? 0 : info->shown;
}

double greenloop_multigrid_time_step(const greenloop_model* model) {
  const layout::MultigridInfo* const info = elastic_info_of(model);
  return info == nullptr ? 0 : info->time_step;
}

greenloop_multigrid_requirement greenloop_multigrid_required(const greenloop_model* model,
                                                             greenloop_multigrid_limits limits) {
  const Multigrid::Requirement need = Multigrid::required(model_in(model), elastic_limits_of(limits));
  return {need.bytes, need.least_work, need.cycle_work, need.shown_work, need.stress_work};
}

greenloop_multigrid_created greenloop_multigrid_create(const greenloop_model* model, greenloop_multigrid_limits limits,
                                                       void* memory, size_t bytes) {
  const auto created =
      Multigrid::create(model_in(model), elastic_limits_of(limits), {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_create_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_multigrid*>(std::bit_cast<ElasticBody*>(created.body))};
}

greenloop_multigrid_report greenloop_multigrid_step(greenloop_multigrid* body, greenloop_multigrid_inputs inputs,
                                                    uint64_t work, greenloop_multigrid_buffers buffers) {
  const ElasticBody& kept = *reinterpret_cast<const ElasticBody*>(body);
  const layout::MultigridInfo& info = *kept.view.info;
  const Multigrid::Inputs given{{reinterpret_cast<const Multigrid::Load*>(inputs.loads), inputs.load_count},
                                {reinterpret_cast<const Multigrid::Hold*>(inputs.holds), inputs.hold_count},
                                reinterpret_cast<const Vec3*>(inputs.gravity)};
  const Multigrid::Response response{vectors(buffers.displacement, buffers.vertices),
                                     {buffers.chosen, buffers.chosen == nullptr ? 0 : buffers.vertices},
                                     vectors(buffers.reaction, inputs.hold_count),
                                     vectors(buffers.shown, info.shown),
                                     {buffers.stress, buffers.stress == nullptr ? 0 : info.vertices}};
  const Multigrid::StepReport report = elastic_in(body).step(given, {work}, response);
  return {static_cast<greenloop_status>(report.status),
          report.work,
          report.refused,
          report.residual,
          report.cycles,
          report.passes};
}

greenloop_multigrid_energy greenloop_multigrid_energy_of(const greenloop_multigrid* body) {
  const Multigrid::Energy energy = elastic_in(body).energy();
  return {energy.kinetic, energy.elastic};
}
