#include "runtime/elastostatic.hpp"

#include <cassert>
#include <cmath>
#include <cstring>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/planner.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

namespace {

// the finest level of the nodes that the response has room for; none if that is no level
std::uint32_t finest_displaced(const Body& body, const Response& response) {
  for (std::uint32_t q = body.counts.levels; q-- > 0 && !body.counts.forces_only;) {
    if (response.displacement.size() == 4 * body.counts.nodes[q]) {
      return q;
    }
  }
  return layout::none;
}

Status check_request(const Body& body, std::size_t contacts, Budget budget, const Response& response) {
  if (budget.work < body.least_work) {
    return Status::held_over_budget;
  }
  if (contacts > body.counts.max_contacts) {
    return Status::held_out_of_range;
  }
  const bool field_fits = response.displacement.empty() ||
                          (finest_displaced(body, response) != layout::none &&
                           reinterpret_cast<std::uintptr_t>(response.displacement.data()) % alignof(Float4) == 0);
  return response.force.size() == 3 * contacts && field_fits ? Status::ok : Status::held_response_size;
}

// fresh factors of body.set; null if its capacitance matrix is not positive definite
Factor* factorise(Body& body) {
  Factor& factor = body.cache.make_room(body.set);
  const std::uint32_t columns = body.set.columns;
  assemble_capacitance(body.refinement, {columns, body.set.column}, body.touched, body.capacitance, body.force,
                       body.cache.stride(), factor.matrix);
  factor.changes = 0;
  for (std::uint32_t k = 0; k < columns; ++k) {
    factor.node[k] = body.set.column[k];
    factor.position[k] = k;
  }
  return cholesky_factor(3 * columns, body.cache.stride(), factor.matrix) ? &factor : nullptr;
}

Factor* make_factor(Body& body, bool update) {
  drop_batch(body);
  if (!update) {
    return factorise(body);
  }
  const CapacitanceSource source{body.refinement, body.touched, body.capacitance, body.force};
  return update_factor(body.cache, body.set, body.changes, source, body.update);
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

// forces of the columns in body.column_force; false if they would overflow the answer
bool solve_forces(Body& body, std::span<const Contact> contacts, const Factor& factor) {
  const std::uint32_t order = 3 * body.set.columns;
  auto* force = reinterpret_cast<float*>(body.column_force);
  auto* solution = reinterpret_cast<float*>(body.solution);
  average_displacements(contacts, body.set, force);
  for (std::uint32_t i = order; i < padded_order(order); ++i) {
    solution[i] = 0;
  }
  to_factor_order(factor, body.set.columns, force, solution);
  cholesky_solve(order, body.cache.stride(), factor.matrix, body.solution);
  to_set_order(factor, body.set.columns, solution, force);
  float sum = 0;
  for (std::uint32_t i = 0; i < order; ++i) {
    sum += std::fabs(force[i]);
  }
  return sum <= body.force_limit;
}

// whether a contact of the set is resolved at the finest level
bool is_finest(const Body& body, std::size_t contact) {
  return column_level(body.set.column[body.set.place[contact]]) + 1 == body.counts.levels;
}

void answer_field(Body& body, std::span<const Contact> contacts, const FieldLevels& levels,
                  std::span<float> displacement) {
  const ColumnForces forces{body.set.columns, body.set.column, reinterpret_cast<const float*>(body.column_force)};
  auto* x = reinterpret_cast<Float4*>(displacement.data());
  compute_field(body.field_model(), forces, body.touched, levels, body.field_scratch(), x);
  // nodes that are held by themselves stand where they are held: only the others need the approximation
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const float* held = contacts[i].displacement;
    if (is_finest(body, i) && contacts[i].node < body.counts.nodes[levels.nodes]) {
      x[contacts[i].node] =
          Float4{without_denormals(held[0]), without_denormals(held[1]), without_denormals(held[2]), 0.0F};
    }
  }
}

// nothing is touched: the body is at rest
void release(const Body& body, const Response& response, StepReport& report) {
  const ModelView& view = *body.view;
  if (!response.displacement.empty()) {
    std::memset(response.displacement.data(), 0, response.displacement.size_bytes());
    report.work += response.displacement.size() / 4;
  }
  report.constraint_level = report.finer_level = view.levels - 1;
  report.field_level = response.displacement.empty() ? view.levels - 1 : finest_displaced(body, response);
}

StepReport held(Status status, std::uint64_t work) {
  StepReport report;
  report.status = status;
  report.work = work;
  return report;
}

// the forces that the level before would answer with, if its factor is cached and the budget holds them; else null
const float* solve_older_level(Body& body, std::span<const Contact> contacts, std::uint64_t budget,
                               std::uint64_t& work) {
  if (!body.glide.follows() || work + older_forces_work(body.counts, contacts.size()) > budget) {
    return nullptr;
  }
  resolve_contacts(contacts, *body.view, body.facts, {body.glide.older_level()}, body.set);
  work += resolve_contacts_work(contacts.size()) + FactorCache::find_work(body.counts.cached_factors, body.set.columns);
  Factor* const factor = body.cache.find(body.set);
  if (factor == nullptr) {
    return nullptr;
  }
  body.cache.use(*factor);
  work += solve_work(contacts.size(), body.set.columns);
  if (!solve_forces(body, contacts, *factor)) {
    return nullptr;
  }
  float* const force = body.glide.older_force();
  share_forces(reinterpret_cast<const float*>(body.column_force), contacts.size(), body.set, force);
  return force;
}

// blends the level's forces with those of the level before, if that is another
void glide_forces(Body& body, std::span<const Contact> contacts, std::uint64_t budget, float* force,
                  StepReport& report) {
  body.glide.advance(contacts, body.set);
  const float* const older = solve_older_level(body, contacts, budget, report.work);
  const GlideReport glide = body.glide.blend(contacts, older, force);
  report.glide = glide.share;
  report.level_difference = glide.difference;
  report.switch_work = glide.switch_work;
}

// what is left of the budget goes into the factor that a finer level lacked
void prepare_finer_level(Body& body, std::span<const Contact> contacts, const Plan& plan, std::uint64_t budget,
                         StepReport& report) {
  if (!plan.wanted.exists || plan.wanted.level <= report.constraint_level) {
    return;
  }
  // the step that makes a mixed factor has had the scratch, and its share of the work
  const bool mixed = plan.resolution.fine != nullptr && plan.cached == nullptr;
  const std::uint64_t resolving = resolve_contacts_work(contacts.size());
  const std::uint64_t limit = budget < body.counts.refining_work ? budget : body.counts.refining_work;
  if (mixed || report.work + resolving > limit) {
    report.pending_work = pending_work(body.counts, plan.wanted.counts);
    return;
  }
  resolve_contacts(contacts, *body.view, body.facts, {plan.wanted.level}, body.set);
  report.work += resolving;
  const std::uint64_t left = limit - report.work;
  const std::uint64_t most = most_slice_work(body.counts, plan.wanted.counts) + drop_batch_work(body.pending);
  const PendingProgress progress = continue_factor(body, plan.wanted.counts, left < most ? left : most);
  report.work += progress.work;
  report.pending_work = progress.pending;
}

StepReport answer(Body& body, std::span<const Contact> contacts, const Plan& plan, std::uint64_t work,
                  std::uint64_t budget, const Response& response) {
  const ModelView& view = *body.view;
  Factor* factor = plan.cached;
  if (factor == nullptr) {
    work += plan.factor;
    factor = make_factor(body, plan.update);
    if (factor == nullptr) {
      return held(Status::held_singular, work);
    }
  }
  body.cache.keep(*factor, body.set);
  work += force_work(plan.counts);
  if (!solve_forces(body, contacts, *factor)) {
    return held(Status::held_overflow, work);
  }
  share_forces(reinterpret_cast<const float*>(body.column_force), contacts.size(), body.set, response.force.data());
  if (!response.displacement.empty()) {
    work += plan.field;
    answer_field(body, contacts, plan.field_levels, response.displacement);
  }
  StepReport report;
  report.constraint_level = body.set.coarsest();
  report.finer_level = body.set.finest();
  for (std::uint32_t k = 0; k < body.set.columns; ++k) {
    report.finer_contacts += column_level(body.set.column[k]) == report.finer_level ? body.set.members[k] : 0;
  }
  report.field_level = plan.field_levels.details;
  report.error = view.level[report.constraint_level].counts->field_error;
  report.work = work;
  glide_forces(body, contacts, budget, response.force.data(), report);
  body.cache.use(*factor);
  prepare_finer_level(body, contacts, plan, budget, report);
  report.cached_factor = plan.cached != nullptr;
  report.changed_nodes = plan.update ? body.changes.added + body.changes.removed : 0;
  const bool finest =
      report.constraint_level + 1 == view.levels && plan.field_levels.details == plan.field_levels.nodes;
  report.status = finest && report.glide == 1 ? Status::ok : Status::coarser;
  return report;
}

}  // namespace

Intent Elastostatic::intended(const Model& model) noexcept {
  const layout::Info& info = *model.view().info;
  return {.limits = {.max_contacts = info.max_contacts}, .budget = {info.step_work}, .rate = info.rate};
}

Requirement Elastostatic::required(const Model& model, const Limits& limits) noexcept {
  BodySizes sizes;
  Requirement requirement;
  measure_body(model.view(), limits, sizes, requirement);
  if (!sizes.supported) {
    return {};
  }
  Arena counting;
  place_body(counting, model.view(), sizes);
  requirement.bytes = counting.bytes() <= SIZE_MAX ? static_cast<std::size_t>(counting.bytes()) : 0;
  return requirement;
}

Elastostatic::Created Elastostatic::create(const Model& model, const Limits& limits,
                                           std::span<std::byte> memory) noexcept {
  const ModelView& view = model.view();
  Created created;
  created.available = memory.size();
  BodySizes sizes;
  Requirement requirement;
  measure_body(view, limits, sizes, requirement);
  if (!sizes.supported) {
    created.error = in_range(limits) ? CreateError::unsupported_model : CreateError::bad_limits;
    return created;
  }
  Arena counting;
  place_body(counting, view, sizes);
  if (counting.bytes() > memory.size()) {
    created.requested = counting.bytes() <= SIZE_MAX ? static_cast<std::size_t>(counting.bytes()) : 0;
    created.error = CreateError::arena_too_small;
    created.missing = created.requested - memory.size();
    return created;
  }
  created.requested = static_cast<std::size_t>(counting.bytes());
  if (reinterpret_cast<std::uintptr_t>(memory.data()) % requirement.alignment != 0) {
    created.error = CreateError::arena_misaligned;
    return created;
  }
  Arena arena(memory.data());
  created.body.body_ = place_body(arena, view, sizes);
  created.body.body_->least_work = requirement.least_work;
  return created;
}

StepReport Elastostatic::step(std::span<const Contact> contacts, Budget budget, const Response& response) noexcept {
  Body& body = *body_;
  const Status request = check_request(body, contacts.size(), budget, response);
  if (request != Status::ok) {
    return held(request, 0);
  }
  StepReport report;
  report.work = check_contacts_work(contacts.size());
  const auto [checked, refused] = check_contacts(contacts, body.view->node_count, body.facts);
  if (checked != Status::ok) {
    report.status = checked;
    report.refused = refused;
    return report;
  }
  if (contacts.empty()) {
    body.glide.release();
    release(body, response, report);
  } else {
    const bool wants_field = !response.displacement.empty();
    const std::uint32_t displaced = wants_field ? finest_displaced(body, response) : body.counts.levels - 1;
    const Plan plan = make_plan(body, contacts, budget.work - report.work, wants_field, displaced);
    report = plan.fits ? answer(body, contacts, plan, report.work + plan.work, budget.work, response)
                       : held(Status::held_over_budget, report.work + plan.work);
  }
  assert(Arena::intact(body.last_red_zone));
  return report;
}

}  // namespace greenloop
