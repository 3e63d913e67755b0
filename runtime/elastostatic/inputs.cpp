#include "runtime/elastostatic/inputs.hpp"

#include <algorithm>

#include "runtime/elastostatic/known_forces.hpp"
#include "runtime/elastostatic/unilateral.hpp"

namespace greenloop {
namespace {

Status check_surfaces(const Body& body, std::size_t surfaces, const Elastostatic::Loads& loads,
                      const Elastostatic::UnilateralResponse& response) {
  const auto fits = [&](std::size_t size) { return size == 0 || size == surfaces; };
  if (!fits(response.state.size()) || !fits(response.gap.size())) {
    return Status::held_response_size;
  }
  if (surfaces > body.counts.max_contacts) {
    return Status::held_out_of_range;
  }
  return body.counts.iterations == 0 && surfaces > 0 ? Status::held_unsupported : check_loads(body, loads);
}

bool is_mixed(const Constraint& constraint) {
  return is_contact(constraint) && constraint.kind != Constraint::Kind::hold;
}

// nodes of the contacts, those of masks each time
std::uint64_t count_corners(std::span<const Constraint> constraints, const Masks& masks) {
  std::uint64_t count = 0;
  for (const Constraint& constraint : constraints) {
    const std::uint32_t number = constraint.node;
    if (constraint.kind == Constraint::Kind::mask && number < masks.scalar.size()) {
      count += masks.scalar[number].node.size();
    } else if (constraint.kind == Constraint::Kind::normal && number < masks.directed.size()) {
      count += masks.directed[number].node.size();
    } else {
      count += is_contact(constraint) ? 1 : 0;
    }
  }
  return count;
}

// checked contacts of which some are mixed
void take_mixed(Body& body, const Masks& masks, Contacts& contacts) {
  MixedScratch& scratch = body.mixed;
  contacts.mixed_counts = list_mixed(contacts.all, masks, scratch);
  contacts.held = {scratch.hold, contacts.mixed_counts.holds};
  contacts.force = scratch.hold_force;
  contacts.mixed = &scratch;
}

}  // namespace

std::uint32_t finest_displaced(const Body& body, const Elastostatic::Response& response) noexcept {
  for (std::uint32_t q = body.counts.levels; q-- > 0 && !body.counts.forces_only;) {
    if (response.displacement.size() == body.counts.nodes[q]) {
      return q;
    }
  }
  return layout::none;
}

Status check_request(const Body& body, std::size_t constraints, Budget budget,
                     const Elastostatic::Response& response) noexcept {
  if (budget.work < body.least_work) {
    return Status::held_over_budget;
  }
  if (constraints > std::size_t{body.counts.max_contacts} + body.counts.max_forces) {
    return Status::held_out_of_range;
  }
  const bool field_fits = response.displacement.empty() ||
                          (finest_displaced(body, response) != layout::none &&
                           reinterpret_cast<std::uintptr_t>(response.displacement.data()) % alignof(Float4) == 0);
  return response.force.size() == constraints && field_fits ? Status::ok : Status::held_response_size;
}

void accept_contacts(Body& body, std::span<const Constraint> contacts, std::span<Vec3> force,
                     Accepted& accepted) noexcept {
  body.stiffness = 1;
  body.is_loaded = false;
  accepted.work = check_contacts_work(body.counts.prices, contacts.size());
  accepted.checked = check_holds(contacts, body.view->node_count, body.facts, body.counts.max_contacts);
  accepted.contacts.all = accepted.contacts.held = contacts;
  accepted.contacts.force = as_floats(force).data();
}

void accept_loaded(Body& body, std::span<const Constraint> constraints, const Elastostatic::Loads& loads,
                   std::span<Vec3> force, Accepted& accepted) noexcept {
  const Status acting = check_loads(body, loads);
  if (acting != Status::ok) {
    accepted.checked.status = acting;
    return;
  }
  const ModelCounts& counts = body.counts;
  const Masks masks{loads.masks, loads.directed};
  const bool mixed = counts.mixed_contacts && std::any_of(constraints.begin(), constraints.end(), is_mixed);
  const std::uint64_t forces = counts.max_forces > 0 ? count_forces(constraints, masks) : 0;
  accepted.work =
      check_loaded_work(counts.prices, constraints.size(), forces < counts.max_forces ? forces : counts.max_forces);
  if (mixed) {
    const std::uint64_t corners = count_corners(constraints, masks);
    accepted.work += list_mixed_work(counts.prices, constraints.size(),
                                     corners < counts.max_contacts ? corners : counts.max_contacts);
  }
  accepted.checked = check_contacts(constraints, body.view->node_count, body.facts,
                                    {counts.max_contacts, counts.max_forces, masks.scalar, masks.directed, mixed});
  if (accepted.checked.status == Status::ok && !take_loads(body, constraints, loads, force, accepted.contacts)) {
    accepted.checked.status = Status::held_overflow;
  }
  if (accepted.checked.status == Status::ok && mixed) {
    take_mixed(body, masks, accepted.contacts);
  }
}

void accept_surfaces(Body& body, std::span<const UnilateralContact> surfaces, const Elastostatic::Loads& loads,
                     const Elastostatic::UnilateralResponse& response, ContactAnswer& found,
                     Accepted& accepted) noexcept {
  CheckedContacts& checked = accepted.checked;
  checked.status = check_surfaces(body, surfaces.size(), loads, response);
  if (checked.status != Status::ok) {
    return;
  }
  const std::uint32_t most = body.counts.max_contacts;
  const Prices& prices = body.counts.prices;
  UnilateralScratch& scratch = body.unilateral;
  scratch.held = 0;
  body.surfaces = static_cast<std::uint32_t>(surfaces.size());
  std::uint32_t nodes = 0;
  accepted.work = list_unilateral_work(prices, surfaces.size(), most) + check_loaded_work(prices, most, 0);
  checked = list_unilateral(surfaces, body.view->node_count, most, scratch, nodes);
  const std::span<const Constraint> holds{scratch.hold, nodes};
  if (checked.status == Status::ok) {
    checked = check_contacts(holds, body.view->node_count, body.facts, {most, 0, {}});
    checked.refused = checked.status == Status::ok ? checked.refused : contact_of(scratch, checked.refused);
  }
  if (checked.status == Status::ok && !take_loads(body, holds, loads, {}, accepted.contacts)) {
    checked.status = Status::held_overflow;
  }
  Contacts& contacts = accepted.contacts;
  contacts.held = holds;
  contacts.force = scratch.hold_force;
  contacts.surfaces = surfaces;
  contacts.output = {response.force, response.state, response.gap, response.yield, response.by_loads};
  contacts.found = &found;
  contacts.corner_count = surfaces.empty() || checked.status != Status::ok ? 0 : scratch.begin[surfaces.size()];
}

}  // namespace greenloop
