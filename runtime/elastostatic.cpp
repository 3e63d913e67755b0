#include "runtime/elastostatic.hpp"

#include <cassert>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/inputs.hpp"
#include "runtime/elastostatic/planner.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// the factor of the planned set; null if its capacitance matrix is not positive definite
Factor* find_factor(Body& body, const Plan& plan) {
  if (plan.cached != nullptr) {
    body.cache.use(*plan.cached);  // also if the answer overflows
    return plan.cached;
  }
  if (!plan.update || body.changes.added > 0) {
    drop_batch(body.job, body.capacitance);  // nodes only leave without it
  }
  Factor* const made =
      make_factor(body.factor_tools(), body.planned.all(), body.touched, plan.update ? &body.changes : nullptr);
  if (made != nullptr) {
    body.cache.keep(*made, body.planned.all());
  }
  return made;
}

// three numbers of each column, between the order of the set and that of a factor
void to_factor_order(const Factor& factor, std::uint32_t columns, const float* of_set, float* of_factor) {
  for (std::uint32_t k = 0; k < columns; ++k) {
    std::memcpy(of_factor + std::size_t{3} * factor.position[k], of_set + std::size_t{3} * k, 3 * sizeof(float));
  }
}
void to_set_order(const Factor& factor, std::uint32_t columns, const float* of_factor, float* of_set) {
  for (std::uint32_t k = 0; k < columns; ++k) {
    std::memcpy(of_set + std::size_t{3} * k, of_factor + std::size_t{3} * factor.position[k], 3 * sizeof(float));
  }
}

// whether so many components of forces could overflow the answer
bool can_overflow(const Body& body, std::uint32_t components, const float* force) {
  float sum = 0;
  for (std::uint32_t i = 0; i < components; ++i) {
    sum += std::fabs(force[i]);
  }
  return !(sum <= body.force_limit && sum * body.stiffness <= FLT_MAX);
}

// forces of the columns of a set by its factor, in `force`; displaced: what of them is there without these forces, or
// null; false if they would overflow the answer
bool solve_forces(const Body& body, std::span<const Constraint> contacts, const ContactSet& set, const Factor& factor,
                  const float* displaced, float* force) {
  const std::uint32_t order = 3 * set.columns;
  auto* solution = reinterpret_cast<float*>(body.solution);
  average_displacements(contacts, set, force);
  for (std::uint32_t i = 0; i < order && displaced != nullptr; ++i) {
    force[i] = without_tiny(force[i] - displaced[i]);
  }
  for (std::uint32_t i = order; i < padded_order(order); ++i) {
    solution[i] = 0;
  }
  to_factor_order(factor, set.columns, force, solution);
  cholesky_solve(order, body.cache.stride(), factor.matrix, body.solution);
  to_set_order(factor, set.columns, solution, force);
  return !can_overflow(body, 3 * set.columns, force);
}

// sums of the known forces; returns the model's loads
[[gnu::noinline]] ActingLoads sum_known_forces(const Body& body, const FieldLevels& levels) {
  const KnownForces& forces = body.loads->forces;
  sum_forces<3>(body.field_model(), forces.on_columns(), forces.touched, domain_up_to(*body.view, levels.details),
                body.field_scratch());
  return body.loads->acting();
}

// displacements by the forces of the planned set, and what acts besides; apart, so that what makes a factor does not
// stand on its stack
[[gnu::noinline]] void reconstruct(const Body& body, std::span<const Constraint> contacts, const ColumnForces& forces,
                                   const FieldLevels& levels, std::span<Vec4> displacement) {
  auto* x = reinterpret_cast<Float4*>(displacement.data());
  const ActingLoads loads = body.is_loaded ? sum_known_forces(body, levels) : ActingLoads{};
  compute_field<3>(body.field_model(), forces, body.touched, levels, body.field_scratch(), x, loads);
  // nodes that are held by themselves stand where they are held: only the others need the approximation
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const float* held = contacts[i].value;
    if (body.planned.level() + 1 == body.counts.levels && body.planned.holds(i) &&
        contacts[i].node < body.counts.nodes[levels.nodes]) {
      x[contacts[i].node] = Float4{without_tiny(held[0]), without_tiny(held[1]), without_tiny(held[2]), 0.0F};
    }
  }
}

// nothing is touched: the body is at rest
void release(Body& body, const Elastostatic::Response& response, std::uint64_t work, Elastostatic::StepReport& report) {
  body.last.release();
  body.mixed.last.release();
  body.planned.columns = 0;
  body.answered = true;
  const std::uint32_t finest = body.view->levels - 1;
  if (!response.displacement.empty()) {
    std::memset(static_cast<void*>(response.displacement.data()), 0, response.displacement.size_bytes());
    work += rest_field_work(body.counts.prices, response.displacement.size());
  }
  report.work = work;
  report.constraint_level = finest;
  report.field_level = response.displacement.empty() ? finest : finest_displaced(body, response);
}

void hold(Status status, std::uint64_t work, Elastostatic::StepReport& report) {
  report.status = status;
  report.work = work;
  report.error = std::numeric_limits<float>::infinity();
}

// the forces that the level before would answer with, if its factor is cached and the budget holds them; else null
const float* solve_older_level(Body& body, std::span<const Constraint> contacts, std::uint64_t budget,
                               std::uint64_t& work) {
  // where loads act it would take their displacements at that level, too: the last known difference does then
  if (!body.glide.follows() || body.is_loaded || work + older_forces_work(body.counts, contacts.size()) > budget) {
    return nullptr;
  }
  ContactSet& set = body.other;
  resolve_contacts(contacts, *body.view, body.facts, body.glide.older_level(), body.resolution, set);
  work += resolve_contacts_work(body.counts.prices, contacts.size()) +
          FactorCache::find_work(body.counts.prices, body.counts.cached_factors, set.columns);
  Factor* const factor = body.cache.find(set.all());
  if (factor == nullptr) {
    return nullptr;
  }
  body.cache.use(*factor);
  work += solve_work(body.counts.prices, contacts.size(), set.columns);
  if (!solve_forces(body, contacts, set, *factor, nullptr, body.other_column_force)) {
    return nullptr;
  }
  share_forces(body.other_column_force, contacts.size(), set, body.older_force);
  return body.older_force;
}

void report_glide(const GlideReport& glide, Elastostatic::StepReport& report) {
  report.details.glide = glide.share;
  report.details.level_difference = glide.difference;
  report.details.switch_work = glide.work;
}

// blends the level's forces with those of the level before, if that is another, and remembers the answer
[[gnu::noinline]] void glide_forces(Body& body, std::span<const Constraint> contacts, std::uint64_t budget,
                                    float* force, Elastostatic::StepReport& report) {
  body.glide.advance(contacts, body.planned, body.last);
  const float* const older = solve_older_level(body, contacts, budget, report.work);
  const GlideReport glide = body.glide.blend(contacts, body.last, older, force);
  body.last.remember(contacts, body.planned, force);
  report_glide(glide, report);
}

// what the glide to a finer level begins with, if its factor has just been completed
void foresee_finer_level(Body& body, std::span<const Constraint> contacts) {
  Factor* const factor = body.cache.find(body.other.all());
  if (factor != nullptr && solve_forces(body, contacts, body.other, *factor, nullptr, body.other_column_force)) {
    share_forces(body.other_column_force, contacts.size(), body.other, body.older_force);
    body.glide.foresee(body.other.level(), body.last, body.older_force);
  }
}

// what is left of the budget goes into the factor that the finest level lacked. moving: the contacts are not the last
// step's
void prepare_factor(Body& body, const Contacts& all, const Plan& plan, bool moving, std::uint64_t budget,
                    Elastostatic::StepReport& report) {
  const std::span<const Constraint> contacts = all.held;
  const bool waits = body.planned.waiting > 0;
  if (!plan.wanted.exists || (plan.wanted.level <= report.constraint_level && !waits)) {
    return;
  }
  const SetCounts& whole = plan.wanted.counts;
  const std::uint64_t resolving = resolve_contacts_work(body.counts.prices, contacts.size());
  const bool glides = !waits && !body.is_loaded && body.counts.glide_cycles > 1 && all.are_held();
  const std::uint64_t foreseeing = glides ? force_work(body.counts.prices, whole) : 0;
  const std::uint64_t limit = budget < body.counts.refining_work ? budget : body.counts.refining_work;
  if (report.work + resolving + foreseeing > limit) {
    report.details.pending_work = pending_work(body.counts, whole);
    return;
  }
  resolve_contacts(contacts, *body.view, body.facts, plan.wanted.level, body.resolution, body.other);
  report.work += resolving;
  const std::uint64_t left = limit - report.work - foreseeing;
  const std::uint64_t made = waits && plan.cached == nullptr ? plan.factor : 0;
  const std::uint64_t most = most_slice_work(body.counts, whole) + drop_batch_work(body.counts.prices, body.job) - made;
  const FactorProgress progress =
      continue_factor(body.job, body.factor_tools(), body.other.all(), whole,
                      {left < most ? left : most, moving || waits, waits || all.found != nullptr});
  report.work += progress.work;
  report.details.pending_work = progress.pending;
  if (progress.pending == 0 && glides) {
    foresee_finer_level(body, contacts);
    report.work += foreseeing;
  }
}

float larger(float a, float b) { return a > b ? a : b; }

// an error that was measured; nothing is known where it was not
float measured(float error) { return error > 0 ? error : std::numeric_limits<float>::infinity(); }

// what an answer was measured to be off by: forces, the field with the details that it has, and while forces go over
// from an answer to another the worse of both
float answer_error(const Body& body, const Plan& plan, bool with_field, const Elastostatic::StepReport& report) {
  if (report.details.waiting_contacts > 0) {
    return measured(0);
  }
  const layout::Level& counts = *body.view->level[report.constraint_level].counts;
  float error = measured(counts.force_error);
  if (with_field) {
    const bool whole = plan.field_levels.details == plan.field_levels.nodes;
    const layout::Level& details = *body.view->level[plan.field_levels.details].counts;
    error = larger(error, measured(whole ? counts.field_error : details.cut_error));
  }
  return report.details.glide < 1 ? larger(error, body.last.error()) : error;
}

// with the details of all nodes that were asked for, at the finest level
bool is_finest(const Body& body, const Plan& plan) {
  return plan.level + 1 == body.view->levels && plan.field_levels.details == plan.field_levels.nodes;
}

// no contacts, but known forces
void answer_loads(Body& body, const Contacts& contacts, const Plan& plan, std::uint64_t work,
                  const Elastostatic::Response& response, Elastostatic::StepReport& report) {
  report.work = report.details.needed_work = work + plan.forces + plan.field;
  report.constraint_level = plan.level;
  report.field_level = plan.field_levels.details;
  if (!response.displacement.empty()) {
    reconstruct(body, {}, {}, plan.field_levels, response.displacement);
  }
  report.error = answer_error(body, plan, !response.displacement.empty(), report);
  report.status = is_finest(body, plan) ? Status::ok : Status::coarser;
  body.last.release();
  body.answered = true;
  if (contacts.found == nullptr) {
    hand_out_forces(body, contacts, response.force, report);
  }
}

// a solution for unilateral contacts whose residual is below this is as good as the compliance is
constexpr float unilateral_residual = 2e-4F;

// forces of unilateral contacts on the columns of a set; none are written if there are none, or they could overflow the
// answer. allowance: for ContactProblem. work: grows by what they took
Status push(Body& body, const Contacts& contacts, const ContactSet& set, const Factor& factor, const float* displaced,
            std::uint64_t allowance, std::uint64_t& work) {
  const UnilateralSet all{contacts.surfaces, set, displaced, body.stiffness};
  ContactAnswer& found = *contacts.found;
  const Prices& prices = body.counts.prices;
  const std::uint64_t most = body.counts.iterations * ContactProblem::least_work(prices, contacts.corners());
  found = solve_unilateral(all, factor, body.cache.stride(), {unilateral_residual, body.counts.iterations},
                           allowance < most ? allowance : most, body.unilateral, body.column_force);
  work += gather_unilateral_work(prices, contacts.corners()) + found.work;
  if (!found.valid || can_overflow(body, 3 * set.columns, body.column_force)) {
    return found.valid ? Status::held_overflow : Status::held_unsolved;
  }
  hand_out_unilateral(all, body.unilateral, contacts.output);
  return Status::ok;
}

// the same on the planned set. spare: what the plan leaves of the budget
Status push_planned(Body& body, const Contacts& contacts, const Plan& plan, const Factor& factor,
                    const float* displaced, std::uint64_t spare, std::uint64_t& work) {
  const Prices& prices = body.counts.prices;
  work += Glide::blend_work(prices, plan.counts.contacts);
  const std::uint64_t planned = unilateral_work(prices, plan.counts.corners, plan.counts.iterations) -
                                gather_unilateral_work(prices, plan.counts.corners);
  return push(body, contacts, body.planned, factor, displaced, planned + spare, work);
}

// forces of mixed contacts on the columns of the planned set
Status hold_mixed(const Body& body, MixedScratch& scratch, const Factor& factor, const float* displaced) {
  const bool finest = body.planned.level() + 1 == body.counts.levels;
  const MixedSet all{body.planned, factor, body.cache.stride(), displaced, finest};
  if (solve_mixed(all, scratch, body.column_force) > 0 && finest) {
    return Status::held_singular;
  }
  return can_overflow(body, 3 * body.planned.columns, body.column_force) ||
                 can_overflow(body, 3 * scratch.contacts, scratch.force)
             ? Status::held_overflow
             : Status::ok;
}

// the forces of the columns of the planned set, in Body::column_force, and of its contacts; `work` grows by what that
// took. spare: what the plan leaves of the budget
Status find_forces(Body& body, const Contacts& contacts, const Plan& plan, std::uint64_t spare, Factor*& factor,
                   std::uint64_t& work) {
  body.factoring.spent = 0;
  factor = find_factor(body, plan);
  work += plan.cached != nullptr ? 0 : plan.factor - plan.bounded + body.factoring.spent;
  if (factor == nullptr) {
    return Status::held_singular;
  }
  const float* displaced = nullptr;
  if (body.is_loaded) {
    work += displace_by_loads_work(body.counts, plan.counts, body.loads->counts, displace_by_loads(body));
    displaced = body.loads->column_displaced;
  }
  if (contacts.found != nullptr) {
    return push_planned(body, contacts, plan, *factor, displaced, spare, work);
  }
  work += plan.forces;
  if (contacts.mixed != nullptr) {
    return hold_mixed(body, *contacts.mixed, *factor, displaced);
  }
  if (!solve_forces(body, contacts.held, body.planned, *factor, displaced, body.column_force)) {
    return Status::held_overflow;
  }
  share_forces(body.column_force, contacts.held.size(), body.planned, contacts.force);
  return Status::ok;
}

void answer(Body& body, const Contacts& contacts, const Plan& plan, std::uint64_t work, std::uint64_t budget,
            const Elastostatic::Response& response, Elastostatic::StepReport& report) {
  const ContactSet& set = body.planned;
  report.details.needed_work = work + plan.displaced + plan.factor + plan.forces + plan.field;
  Factor* factor = nullptr;
  const Status held = find_forces(body, contacts, plan, budget - report.details.needed_work, factor, work);
  if (held != Status::ok) {
    report.details.needed_work = 0;
    return hold(held, work, report);
  }
  if (!response.displacement.empty()) {
    work += plan.field;
    const std::span<const Constraint> held_nodes = contacts.are_held() ? contacts.held : std::span<const Constraint>();
    reconstruct(body, held_nodes, {set.columns, set.column, body.column_force}, plan.field_levels,
                response.displacement);
    const bool lacks_details = plan.field_levels.details < plan.field_levels.nodes;
    if (contacts.found != nullptr && lacks_details && set.level() + 1 == body.counts.levels) {
      place_contacts({contacts.surfaces, set}, body.unilateral, response.displacement);
    }
  }
  report.work = work;
  report.constraint_level = set.level();
  report.field_level = plan.field_levels.details;
  report.details.held_contacts = static_cast<std::uint16_t>(contacts.held.size() - set.waiting);
  report.details.waiting_contacts = static_cast<std::uint16_t>(set.waiting);
  const bool moving = !body.last.stays(contacts.held);
  if (contacts.are_held()) {
    glide_forces(body, contacts.held, budget, contacts.force, report);
  } else {
    body.glide.stop(set.level());
    if (contacts.mixed != nullptr) {
      share_forces(body.column_force, contacts.held.size(), set, contacts.force);
      report_glide(glide_mixed(contacts.all, set, *contacts.mixed), report);
    }
    body.last.remember(contacts.held, set, contacts.force);
  }
  report.error = answer_error(body, plan, !response.displacement.empty(), report);
  body.last.set_error(report.error);
  body.cache.use(*factor);
  prepare_factor(body, contacts, plan, moving, budget, report);
  report.details.cached_factor = plan.cached != nullptr;
  report.details.changed_nodes = plan.update ? body.changes.added + body.changes.removed : 0;
  const bool finest = is_finest(body, plan) && set.waiting == 0 && report.details.glide == 1;
  report.status = finest ? Status::ok : Status::coarser;
  body.answered = true;
  if (contacts.found == nullptr) {
    hand_out_forces(body, contacts, response.force, report);
  }
}

// surfaces that touch nothing that moves; apart for its stack
[[gnu::noinline]] Status push_rigid(Body& body, const Contacts& contacts, std::uint64_t& work) {
  return push(body, contacts, {}, {}, nullptr, ContactProblem::least_work(body.counts.prices, contacts.corners()),
              work);
}

// a step whose inputs are accepted
void carry_out(Body& body, const Accepted& accepted, Budget budget, const Elastostatic::Response& response,
               Elastostatic::StepReport& report) {
  report.refused = accepted.checked.refused;
  if (accepted.checked.status != Status::ok) {
    return hold(accepted.checked.status, accepted.work, report);
  }
  const Contacts& contacts = accepted.contacts;
  std::uint64_t work = accepted.work;
  if (contacts.mixed == nullptr) {
    body.mixed.last.release();
  }
  if (contacts.held.empty() && !contacts.surfaces.empty()) {
    const Status pushed = push_rigid(body, contacts, work);
    if (pushed != Status::ok) return hold(pushed, work, report);
  }
  if (contacts.held.empty() && !body.is_loaded) {
    return release(body, response, work, report);
  }
  Wants wants;
  wants.budget = budget.work - work;
  wants.field = !response.displacement.empty();
  wants.finest_displaced = wants.field ? finest_displaced(body, response) : body.counts.levels - 1;
  if (contacts.mixed != nullptr) {
    wants.corners = contacts.mixed_counts.corners;
    wants.rows = contacts.mixed_counts.rows;
  } else if (contacts.found != nullptr) {
    wants.corners = contacts.corners();
    wants.keeps_level = true;
  }
  wants.iterations = least_iterations(body.counts.iterations);
  const Plan& plan = *new (body.plan) Plan(make_plan(body, contacts.held, wants));
  work += plan.work;
  if (!plan.fits) {
    return hold(Status::held_over_budget, work, report);
  }
  if (contacts.held.empty()) {
    return answer_loads(body, contacts, plan, work, response, report);
  }
  answer(body, contacts, plan, work, budget.work, response, report);
}

// loads: null where nothing but contacts acts
void take_step(Body& body, std::span<const Constraint> constraints, const Elastostatic::Loads* loads, Budget budget,
               const Elastostatic::Response& response, Elastostatic::StepReport& report) {
  body.answered = body.pushed = false;
  const Status request = check_request(body, constraints.size(), budget, response);
  if (request != Status::ok) {
    return hold(request, 0, report);
  }
  if (constraints.empty() && loads == nullptr) {
    return release(body, response, check_contacts_work(body.counts.prices, 0), report);
  }
  Accepted& accepted = *new (body.accepted) Accepted;
  if (loads == nullptr) {
    accept_contacts(body, constraints, response.force, accepted);
  } else {
    accept_loaded(body, constraints, *loads, response.force, accepted);
  }
  carry_out(body, accepted, budget, response, report);
}

}  // namespace

Elastostatic::StepReport Elastostatic::step(std::span<const Constraint> contacts, Budget budget,
                                            const Response& response) noexcept {
  static constexpr Loads none{};
  StepReport report;
  take_step(*body_, contacts, body_->loads == nullptr ? nullptr : &none, budget, response, report);
  assert(Arena::intact(body_->last_red_zone));
  return report;
}

Elastostatic::StepReport Elastostatic::step(std::span<const Constraint> constraints, const Loads& loads, Budget budget,
                                            const Response& response) noexcept {
  StepReport report;
  take_step(*body_, constraints, &loads, budget, response, report);
  assert(Arena::intact(body_->last_red_zone));
  return report;
}

Elastostatic::UnilateralReport Elastostatic::step(std::span<const UnilateralContact> contacts, const Loads& loads,
                                                  Budget budget, const UnilateralResponse& response) noexcept {
  Body& body = *body_;
  body.answered = false;
  UnilateralReport report;
  ContactAnswer found;
  Accepted& accepted = *new (body.accepted) Accepted;
  accepted.checked.status = check_request(body, contacts.size(), budget, response);
  if (accepted.checked.status == Status::ok) {
    accept_surfaces(body, contacts, loads, response, found, accepted);
  }
  carry_out(body, accepted, budget, response, report);
  body.pushed = greenloop::answered(report.status);
  report.residual = found.residual;
  report.iterations = found.iterations;
  assert(Arena::intact(body.last_red_zone));
  return report;
}

}  // namespace greenloop
