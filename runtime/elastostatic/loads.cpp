#include "runtime/elastostatic/loads.hpp"

#include <algorithm>
#include <cstddef>

#include "runtime/compliance/selected_columns.hpp"

namespace greenloop {
namespace {

bool is_hold(const Constraint& constraint) { return constraint.kind == Constraint::Kind::hold; }

}  // namespace

bool take_loads(Body& body, std::span<const Constraint> constraints, const Elastostatic::Loads& loads,
                std::span<Vec3> force, Contacts& contacts) noexcept {
  body.stiffness = loads.stiffness;
  body.is_loaded = false;
  contacts = {constraints, constraints, as_floats(force).data()};
  float sum = 0;
  if (!std::all_of(constraints.begin(), constraints.end(), is_hold)) {
    LoadState& state = *body.loads;
    const std::uint32_t holds = list_forces(constraints, loads.masks, loads.stiffness, state.forces, state.held, sum);
    contacts = {constraints, {state.held, holds}, state.held_force};
    body.is_loaded = true;
  }
  return sum <= body.force_limit;
}

std::uint64_t displace_by_loads(const Body& body) noexcept {
  const LoadState& loads = *body.loads;
  const KnownForces& forces = loads.forces;
  std::uint64_t between = 0;
  if (forces.count > 0) {
    transform_forces<3>(body.refinement, forces.on_columns(), forces.touched, body.force);
    between = couple_coefficients(body.refinement, forces.touched, body.force, body.touched, loads.displaced);
    clear_forces<3>(forces.touched, body.force);
  }
  displace_columns(body.refinement, body.touched, loads.displaced);
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
  if (contacts.held.size() == contacts.all.size() && scale == 1) {
    return;
  }
  const float* next = contacts.force;
  for (std::size_t i = 0; i < contacts.all.size(); ++i) {
    const float* const known = contacts.all[i].value;
    const bool holds = is_hold(contacts.all[i]);
    force[i] = holds ? Vec3{scale * next[0], scale * next[1], scale * next[2]} : Vec3{known[0], known[1], known[2]};
    next += holds ? 3 : 0;
  }
  report.details.level_difference *= scale;
  report.details.switch_work *= scale;
}

}  // namespace greenloop
