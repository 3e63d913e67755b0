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
  body.forces.count = 0;
  contacts = {constraints, as_floats(force).data()};
  float sum = 0;
  if (!std::all_of(constraints.begin(), constraints.end(), is_hold)) {
    const std::uint32_t holds = list_forces(constraints, loads.masks, loads.stiffness, body.forces, body.held, sum);
    contacts = {{body.held, holds}, body.held_force};
  }
  body.is_loaded = body.forces.count > 0;
  return sum <= body.force_limit;
}

std::uint64_t displace_by_loads(const Body& body) noexcept {
  const KnownForces& forces = body.forces;
  std::uint64_t between = 0;
  if (forces.count > 0) {
    transform_forces<3>(body.refinement, forces.on_columns(), forces.touched, body.force);
    between = couple_coefficients(body.refinement, forces.touched, body.force, body.touched, body.displaced);
    clear_forces<3>(forces.touched, body.force);
  }
  displace_columns(body.refinement, body.touched, body.displaced);
  for (std::uint32_t k = 0; k < body.planned.columns; ++k) {
    const Float4 displaced = body.displaced[column_place(body.planned.column[k])];
    for (std::size_t r = 0; r < 3; ++r) {
      body.column_displaced[3 * std::size_t{k} + r] = displaced[r];
    }
  }
  clear_forces<3>(body.touched, body.displaced);
  return between;
}

void hand_out_forces(const Body& body, std::span<const Constraint> constraints, const Contacts& contacts,
                     std::span<Vec3> force, Elastostatic::StepReport& report) noexcept {
  const float scale = body.stiffness;
  const float* next = contacts.force;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const float* const known = constraints[i].value;
    force[i] = is_hold(constraints[i]) ? Vec3{scale * next[0], scale * next[1], scale * next[2]}
                                       : Vec3{known[0], known[1], known[2]};
    next += is_hold(constraints[i]) ? 3 : 0;
  }
  report.details.level_difference *= scale;
  report.details.switch_work *= scale;
}

}  // namespace greenloop
