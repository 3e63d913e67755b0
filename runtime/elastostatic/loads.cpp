#include "runtime/elastostatic/loads.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>

#include "runtime/compliance/selected_columns.hpp"

namespace greenloop {
namespace {

// of Young's modulus
constexpr float least_stiffness = 0x1p-20F;
constexpr float most_stiffness = 0x1p20F;

bool is_hold(const Constraint& constraint) { return constraint.kind == Constraint::Kind::hold; }

bool is_zero(const Vec3& vector) { return vector.x == 0 && vector.y == 0 && vector.z == 0; }

// adds a load of the model; returns the largest displacement that it may come to
float add_load(std::uint32_t load, float amount, LoadState& state) {
  state.load[state.amounts] = load;
  state.amount[state.amounts++] = amount;
  return std::fabs(amount) * state.largest[load];
}

// false if the model's loads could overflow the answer
bool take_model_loads(const Body& body, const Elastostatic::Loads& loads, LoadState& state) {
  const float softness = 1 / loads.stiffness;
  const std::uint32_t accelerations = body.view->has_gravity() ? layout::accelerations : 0;
  float sum = 0;
  if (!is_zero(loads.gravity)) {
    const float along[] = {loads.gravity.x, loads.gravity.y, loads.gravity.z};
    for (std::uint32_t k = 0; k < accelerations; ++k) {
      sum += add_load(k, softness * along[k], state);
    }
  }
  for (std::uint32_t k = 0; k < loads.pressure.size(); ++k) {
    sum += add_load(accelerations + k, softness * loads.pressure[k], state);
  }
  return sum <= FLT_MAX / 4;
}

void hand_out_holds(const Contacts& contacts, float scale, std::span<Vec3> force) {
  const float* next = contacts.force;
  for (std::size_t i = 0; i < contacts.all.size(); ++i) {
    const float* const known = contacts.all[i].value;
    const bool holds = is_hold(contacts.all[i]);
    const bool directed = contacts.all[i].kind == Constraint::Kind::along;
    force[i] = holds      ? Vec3{scale * next[0], scale * next[1], scale * next[2]}
               : directed ? Vec3{known[0], 0, 0}
                          : Vec3{known[0], known[1], known[2]};
    next += holds ? 3 : 0;
  }
}

}  // namespace

Status check_loads(const Body& body, const Elastostatic::Loads& loads) noexcept {
  const Vec3& g = loads.gravity;
  if (!std::isfinite(loads.stiffness) || !std::isfinite(g.x) || !std::isfinite(g.y) || !std::isfinite(g.z)) {
    return Status::held_not_finite;
  }
  if (loads.stiffness < least_stiffness || loads.stiffness > most_stiffness) {
    return Status::held_out_of_range;
  }
  const bool knows = body.counts.model_loads > 0;
  const bool has_gravity = knows && body.view->has_gravity();
  if ((!is_zero(g) && !has_gravity) || (!loads.pressure.empty() && !knows)) {
    return Status::held_unsupported;
  }
  if (loads.pressure.size() > body.counts.model_loads - (has_gravity ? layout::accelerations : 0)) {
    return Status::held_out_of_range;
  }
  const bool finite =
      std::all_of(loads.pressure.begin(), loads.pressure.end(), [](float amount) { return std::isfinite(amount); });
  return finite ? Status::ok : Status::held_not_finite;
}

bool take_loads(Body& body, std::span<const Constraint> constraints, const Elastostatic::Loads& loads,
                std::span<Vec3> force, Contacts& contacts) noexcept {
  body.stiffness = loads.stiffness;
  body.is_loaded = false;
  contacts = {constraints, constraints, as_floats(force).data()};
  if (body.loads == nullptr) {
    return true;
  }
  LoadState& state = *body.loads;
  state.forces.count = state.amounts = 0;
  float sum = 0;
  if (!std::all_of(constraints.begin(), constraints.end(), is_hold)) {
    const std::uint32_t holds =
        list_forces(constraints, {loads.masks, loads.directed}, loads.stiffness, state.forces, state.held, sum);
    contacts = {constraints, {state.held, holds}, state.held_force};
  }
  const bool bounded = take_model_loads(body, loads, state) && sum <= body.force_limit;
  body.is_loaded = state.forces.count > 0 || state.amounts > 0;
  return bounded;
}

std::uint64_t displace(const Body& body, const ColumnForces& forces, const ActingLoads& acting) noexcept {
  const LoadState& loads = *body.loads;
  const Touched& forced = loads.forces.touched;
  std::uint64_t between = 0;
  if (forces.count > 0) {
    transform_forces<3>(body.refinement, forces, forced, body.force);
    between = couple_coefficients(body.refinement, forced, body.force, body.touched, loads.displaced);
    clear_forces<3>(forced, body.force);
  }
  add_loads(*body.view, acting, body.touched, loads.displaced);
  displace_columns(body.refinement, body.touched, loads.displaced);
  return between;
}

std::uint64_t displace_by_loads(const Body& body) noexcept {
  const LoadState& loads = *body.loads;
  const std::uint64_t between = displace(body, loads.forces.on_columns(), loads.acting());
  for (std::uint32_t k = 0; k < body.planned.columns; ++k) {
    const Float4 displaced = loads.displaced[column_place(body.planned.column[k])];
    for (std::size_t r = 0; r < 3; ++r) {
      loads.column_displaced[3 * std::size_t{k} + r] = displaced[r];
    }
  }
  clear_forces<3>(body.touched, loads.displaced);
  return between;
}

void hand_out_forces(const Body& body, const Contacts& contacts, std::span<Vec3> force,
                     Elastostatic::StepReport& report) noexcept {
  const float scale = body.stiffness;
  if (contacts.mixed != nullptr) {
    hand_out_mixed(contacts.all, *contacts.mixed, scale, force);
  } else if (contacts.held.size() == contacts.all.size() && scale == 1) {
    return;
  } else {
    hand_out_holds(contacts, scale, force);
  }
  report.details.level_difference *= scale;
  report.details.switch_work *= scale;
}

}  // namespace greenloop
