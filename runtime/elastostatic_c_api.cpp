// Contact with an elastic body in C.
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "runtime/c_values.hpp"
#include "runtime/mask.hpp"
#include "runtime/wrench.hpp"

namespace greenloop {
namespace {

// NOLINTBEGIN(misc-redundant-expression): two types are compared
static_assert(sizeof(Constraint) == sizeof(greenloop_constraint) &&
              alignof(Constraint) == alignof(greenloop_constraint) &&
              offsetof(Constraint, node) == offsetof(greenloop_constraint, node) &&
              offsetof(Constraint, value) == offsetof(greenloop_constraint, value) &&
              offsetof(Constraint, kind) == offsetof(greenloop_constraint, kind));
static_assert(sizeof(Prices) == sizeof(greenloop_prices) && std::is_trivially_copyable_v<Prices>);
// a span is a pointer and a size
static_assert(sizeof(Mask) == sizeof(greenloop_mask) && alignof(Mask) == alignof(greenloop_mask) &&
              offsetof(Mask, weight) == offsetof(greenloop_mask, weight) && std::is_trivially_copyable_v<Mask>);
static_assert(sizeof(DirectedMask) == sizeof(greenloop_directed_mask) &&
              offsetof(DirectedMask, part) == offsetof(greenloop_directed_mask, part) &&
              std::is_trivially_copyable_v<DirectedMask> && sizeof(Vec3) == 3 * sizeof(float));
static_assert(sizeof(MeshPoint) == sizeof(greenloop_vertex) &&
              offsetof(MeshPoint, weight) == offsetof(greenloop_vertex, weight));
// NOLINTEND(misc-redundant-expression)
static_assert(sizeof(Elastostatic) == sizeof(void*) && std::is_trivially_copyable_v<Elastostatic>);

}  // namespace

Elastostatic::Limits limits_of(greenloop_elastostatic_limits limits) noexcept {
  Elastostatic::Limits same{.max_contacts = limits.max_contacts,
                            .cached_factors = limits.cached_factors,
                            .forces_only = limits.forces_only != 0,
                            .keep_capacitance = limits.keep_capacitance != 0};
  same.glide_cycles = limits.glide_cycles == 0 ? same.glide_cycles : limits.glide_cycles;
  same.refining_work = limits.refining_work == 0 ? same.refining_work : limits.refining_work;
  if (limits.prices != nullptr) {
    same.prices = std::bit_cast<Prices>(*limits.prices);
  }
  same.max_forces = limits.max_forces;
  same.model_loads = limits.model_loads != 0;
  same.max_points = limits.max_points;
  same.iterations = limits.iterations;
  same.mixed_contacts = limits.mixed_contacts != 0;
  return same;
}

namespace {

std::span<const Mask> masks_of(const greenloop_mask* masks, std::size_t count) {
  return {reinterpret_cast<const Mask*>(masks), count};
}

std::span<Vec3> vectors_of(float* vectors, std::size_t count) { return {reinterpret_cast<Vec3*>(vectors), count}; }

std::span<const MeshPoint> points_of(const greenloop_vertex* points, std::size_t count) {
  return {reinterpret_cast<const MeshPoint*>(points), count};
}

}  // namespace

Elastostatic::Loads loads_of(const greenloop_loads& loads) noexcept {
  return {masks_of(loads.mask, loads.masks),
          {loads.gravity[0], loads.gravity[1], loads.gravity[2]},
          {loads.pressure, loads.pressures},
          loads.stiffness == 0 ? 1 : loads.stiffness,
          {reinterpret_cast<const DirectedMask*>(loads.directed_mask), loads.directed_masks}};
}

greenloop_elastostatic_report report_of(const Elastostatic::StepReport& report) noexcept {
  const Elastostatic::StepDetails& details = report.details;
  return {static_cast<greenloop_status>(report.status),
          report.refused,
          report.work,
          report.constraint_level,
          report.field_level,
          report.error,
          {details.cached_factor ? 1 : 0, details.held_contacts, details.waiting_contacts, details.changed_nodes,
           details.glide, details.level_difference, details.switch_work, details.needed_work, details.pending_work}};
}

}  // namespace greenloop

using namespace greenloop;

greenloop_prices greenloop_default_prices(void) { return std::bit_cast<greenloop_prices>(Prices{}); }

greenloop_prices greenloop_cortex_m7_prices(void) { return std::bit_cast<greenloop_prices>(cortex_m7_prices()); }

greenloop_elastostatic_intent greenloop_elastostatic_intended(const greenloop_model* model) {
  const Elastostatic::Intent intent = Elastostatic::intended(model_in(model));
  const Elastostatic::Limits& limits = intent.limits;
  return {{limits.max_contacts, limits.cached_factors, limits.forces_only ? 1 : 0, limits.keep_capacitance ? 1 : 0,
           limits.glide_cycles, limits.refining_work, nullptr, limits.max_forces, limits.model_loads ? 1 : 0,
           limits.max_points, limits.iterations, limits.mixed_contacts ? 1 : 0},
          intent.budget.work,
          intent.rate,
          intent.share};
}

greenloop_elastostatic_requirement greenloop_elastostatic_required(const greenloop_model* model,
                                                                   greenloop_elastostatic_limits limits) {
  const Elastostatic::Requirement need = Elastostatic::required(model_in(model), limits_of(limits));
  greenloop_elastostatic_requirement requirement = {need.bytes, need.least_work, {}, need.selected_work};
  std::memcpy(requirement.worst_work, need.worst_work, sizeof need.worst_work);
  return requirement;
}

greenloop_elastostatic_created greenloop_elastostatic_create(const greenloop_model* model,
                                                             greenloop_elastostatic_limits limits, void* arena,
                                                             size_t bytes) {
  const auto created =
      Elastostatic::create(model_in(model), limits_of(limits), {static_cast<std::byte*>(arena), bytes});
  return {static_cast<greenloop_create_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_elastostatic*>(std::bit_cast<Body*>(created.body))};
}

greenloop_elastostatic_report greenloop_elastostatic_step(greenloop_elastostatic* body,
                                                          const greenloop_constraint* contacts, size_t count,
                                                          uint64_t work, float* force, float* displacement,
                                                          uint32_t nodes) {
  return report_of(
      body_in(body).step(constraints_of(contacts, count), {work}, response_of(count, force, displacement, nodes)));
}

int greenloop_elastostatic_compliance(const greenloop_elastostatic* body, uint32_t i, uint32_t j, float* block) {
  const auto* const in_arena = reinterpret_cast<const Body*>(body);
  const auto same = std::bit_cast<Elastostatic>(in_arena);
  return same.compliance(i, j, std::span<float, 9>(block, 9)) ? 1 : 0;
}

greenloop_elastostatic_report greenloop_elastostatic_step_loaded(greenloop_elastostatic* body,
                                                                 const greenloop_constraint* constraints, size_t count,
                                                                 const greenloop_loads* loads, uint64_t work,
                                                                 float* force, float* displacement, uint32_t nodes) {
  return report_of(body_in(body).step(constraints_of(constraints, count), loads_of(*loads), {work},
                                      response_of(count, force, displacement, nodes)));
}

int greenloop_has_gravity(const greenloop_model* model) { return model_in(model).view().has_gravity() ? 1 : 0; }

uint32_t greenloop_pressure_count(const greenloop_model* model) {
  const ModelView& view = model_in(model).view();
  return static_cast<uint32_t>(view.loads.size()) - (view.has_gravity() ? layout::accelerations : 0);
}

greenloop_directed_mask greenloop_direct_mask(const greenloop_mask* mask, const float* direction, float* part,
                                              size_t capacity) {
  return std::bit_cast<greenloop_directed_mask>(
      direct_mask(masks_of(mask, 1)[0], {direction[0], direction[1], direction[2]}, vectors_of(part, capacity)));
}

greenloop_directed_mask greenloop_make_torque_mask(const greenloop_model* model, const greenloop_mask* mask,
                                                   const float* axis, float* part, size_t capacity) {
  return std::bit_cast<greenloop_directed_mask>(
      make_torque_mask(model_in(model), masks_of(mask, 1)[0], {axis[0], axis[1], axis[2]}, vectors_of(part, capacity)));
}

uint64_t greenloop_elastostatic_displacements(greenloop_elastostatic* body, const greenloop_vertex* points,
                                              size_t count, float* displacement) {
  return body_in(body).displacements(points_of(points, count), {reinterpret_cast<Vec3*>(displacement), count});
}

uint64_t greenloop_elastostatic_masked_compliance(greenloop_elastostatic* body, uint32_t node,
                                                  const greenloop_mask* mask, float* block) {
  return body_in(body).masked_compliance(node, masks_of(mask, 1)[0], std::span<float, 9>(block, 9));
}

uint64_t greenloop_elastostatic_stiffness(greenloop_elastostatic* body, const greenloop_vertex* point,
                                          const greenloop_mask* masks, float rigid, int capped, float* stiffness) {
  return body_in(body).stiffness(points_of(point, 1)[0], std::span<const Mask, 3>(masks_of(masks, 3)), rigid,
                                 capped != 0, std::span<float, 9>(stiffness, 9));
}

greenloop_wrench greenloop_total_wrench(const float* position, const float* force, size_t count, const float* about) {
  const auto vectors = [count](const float* of) {
    return std::span<const Vec3>(reinterpret_cast<const Vec3*>(of), count);
  };
  return std::bit_cast<greenloop_wrench>(
      total_wrench(vectors(position), vectors(force), {about[0], about[1], about[2]}));
}
