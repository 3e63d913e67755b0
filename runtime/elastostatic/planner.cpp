#include "runtime/elastostatic/planner.hpp"

#include <algorithm>

namespace greenloop {
namespace {

// what the planner knows of a step
struct Task : Wants {
  std::span<const Constraint> contacts;
};

// as much of the field as a plan asks for
std::uint64_t planned_field_work(const Body& body, const Plan& plan) {
  const std::uint32_t details = plan.field_levels.details;
  const std::uint64_t of_contacts = field_work(body.counts, plan.counts, plan.field_levels,
                                               count_field_blocks(body.field_blocks, body.touched, details));
  if (!body.is_loaded) {
    return of_contacts;
  }
  const LoadState& loads = *body.loads;
  return of_contacts + load_field_work(body.counts, loads.counts, details,
                                       count_field_blocks(body.field_blocks, loads.forces.touched, details));
}

// touches the coefficients of the set
void touch_set(Body& body, Plan& plan) {
  clear(body.touched);
  touch(body.refinement, body.planned.column, body.planned.columns, body.touched);
  plan.counts.coefficients = body.touched.coefficients();
  plan.counts.visits = body.touched.visits;
  plan.work += touch_work(body.counts.prices, plan.counts);
}

// bounds what the loads take, whose coefficients are touched as those of the set are
void count_displaced(const Body& body, Plan& plan) {
  LoadCounts& loads = body.loads->counts;
  loads.set_stored = count_stored(body.stored, body.touched);
  plan.work += count_field_work(body.counts.prices, plan.counts);
  plan.displaced = plan.counts.columns == 0 ? 0
                                            : displace_by_loads_work(body.counts, plan.counts, loads,
                                                                     most_coupling_blocks(plan.counts, loads));
}

// resolves the known forces and touches their coefficients
void plan_loads(const Body& body, std::uint32_t level, Plan& plan) {
  KnownForces& forces = body.loads->forces;
  resolve_forces(*body.view, body.facts, level, forces);
  clear(forces.touched);
  touch(body.refinement, forces.column, forces.count, forces.touched);
  SetCounts& counts = body.loads->counts.forces;
  body.loads->counts.amounts = body.loads->amounts;
  counts.columns = forces.count;
  counts.coefficients = forces.touched.coefficients();
  counts.visits = forces.touched.visits;
  counts.stored = count_stored(body.stored, forces.touched);
  plan.work += plan_loads_work(body.counts, {}, body.loads->counts);
  count_displaced(body, plan);
}

// resolves the contacts, looks for the factor, and touches the coefficients unless only forces by a cached one are
// wanted
void plan_set(Body& body, const Task& task, std::uint32_t level, Plan& plan) {
  resolve_contacts(task.contacts, *body.view, body.facts, level, body.resolution, body.planned);
  plan.level = level;
  plan.counts = {};
  plan.counts.contacts = task.contacts.size();
  plan.counts.columns = body.planned.columns;
  plan.counts.corners = task.contacts.empty() ? 0 : task.corners;
  plan.counts.iterations = task.iterations;
  plan.counts.rows = task.rows;
  plan.forces = force_work(body.counts.prices, plan.counts);
  plan.cached = body.planned.columns > 0 ? body.cache.find(body.planned.all()) : nullptr;
  plan.work += resolve_work(body.counts, plan.counts);
  plan.factor = 0;
  plan.reserve = 0;
  plan.update = false;
  if (task.field || plan.cached == nullptr || body.is_loaded) {
    touch_set(body, plan);
  }
  if (body.is_loaded) {
    plan_loads(body, level, plan);
  }
  plan.field = task.field ? planned_field_work(body, plan) : 0;
  plan.fits = false;
}

// whether the answer fits, given the factor
bool holds_answer(const Task& task, const Plan& plan) {
  return plan.work + plan.displaced + plan.forces + plan.field <= task.budget;
}

// chooses how to make the factor of the set
void choose_factor(Body& body, Plan& plan) {
  count_factor(body.planned.all(), body.touched, body.cost, body.stored, plan.counts);
  find_changes(body.cache, body.planned.all(), body.changes);
  plan.work += find_changes_work(body.counts.prices, body.counts.cached_factors, plan.counts.columns);
  plan.factor = factor_work(body.counts, plan.counts);
  plan.bounded = factor_bounded_work(body.counts, plan.counts);
  if (body.changes.base != nullptr) {
    const ChangeCounts changes = count_changes(body.changes, body.cost, body.touched);
    const std::uint64_t update = update_factor_work(body.counts, plan.counts, changes);
    plan.update = update < plan.factor;
    if (plan.update) {
      plan.factor = update;
      plan.bounded = update_bounded_work(body.counts, plan.counts, changes);
    }
  }
  plan.factor += drop_batch_work(body.counts.prices, body.job);
}

// work of the answer that is planned, deciding included
std::uint64_t planned_work(const Plan& plan) {
  return plan.work + plan.displaced + plan.forces + plan.factor + plan.field;
}

// decides where the factor comes from; whether all fits, or else whether the level is wanted
void plan_factor(Body& body, const Task& task, Plan& plan) {
  const bool holds = holds_answer(task, plan);
  if (plan.cached == nullptr && plan.counts.columns > 0) {
    choose_factor(body, plan);
  }
  plan.fits = planned_work(plan) <= task.budget;
  if (!plan.fits && holds && !plan.wanted.exists) {
    plan.wanted = {true, plan.level, plan.counts};
  }
}

// whether a contact may wait, for less steps than a glide takes: one that was not held, or where the level is kept any
bool may_wait(const Body& body, const Task& task, std::uint32_t node) {
  const std::uint32_t place = body.last.place(node);
  const std::uint32_t waited = place == layout::none ? 0 : body.last.waited(place);
  return (task.keeps_level || place == layout::none || waited > 0) && waited + 1 < body.counts.glide_cycles;
}

// whether all contacts may wait that the nearest factor lacks: a quarter of them at most, or where the level is kept
// any but all
bool others_may_wait(const Body& body, const Task& task) {
  const FactorChanges& changes = body.changes;
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < task.contacts.size(); ++i) {
    const std::uint32_t column = body.planned.column[body.planned.place[i]];
    if (std::binary_search(changes.in, changes.in + changes.added, column)) {
      ++waiting;
      if (!may_wait(body, task, task.contacts[i].node)) {
        return false;
      }
    }
  }
  return task.keeps_level || 4 * waiting <= task.contacts.size();
}

// plans an answer by what the nearest factor has of the set, if only the factor is too dear: contacts that are new wait
void plan_without_new(Body& body, const Task& task, Plan& plan) {
  plan.work += resolve_contacts_work(body.counts.prices, task.contacts.size());
  FactorChanges& changes = body.changes;
  if (changes.base == nullptr || changes.added == 0 || changes.added == plan.counts.columns ||
      !others_may_wait(body, task)) {
    return;
  }
  const std::uint64_t whole = plan.factor;
  leave_out({changes.added, changes.in}, task.contacts.size(), body.resolution, body.planned);
  changes.added = changes.missing = 0;
  plan.counts.columns = body.planned.columns;
  plan.forces = force_work(body.counts.prices, plan.counts);
  plan.cached = changes.removed == 0 ? changes.base : nullptr;
  plan.update = plan.cached == nullptr;
  const ChangeCounts leaving{0, changes.removed, {}};
  plan.factor = plan.update ? update_factor_work(body.counts, plan.counts, leaving) : 0;
  plan.bounded = plan.update ? update_bounded_work(body.counts, plan.counts, leaving) : 0;
  if (task.field || body.is_loaded) {
    touch_set(body, plan);
  }
  if (body.is_loaded) {
    count_displaced(body, plan);
  }
  plan.field = task.field ? planned_field_work(body, plan) : 0;
  const std::uint64_t preparing = resolve_contacts_work(body.counts.prices, plan.counts.contacts) +
                                  compare_factors_work(body.counts, plan.counts.columns);
  const std::uint64_t limit = task.budget < body.counts.refining_work ? task.budget : body.counts.refining_work;
  plan.reserve = preparing + task.budget - limit;
  plan.fits = plan.factor <= whole && planned_work(plan) + plan.reserve <= task.budget;
}

// takes details of the field away, the finest first, while the answer does not fit; knows_factor: of the level
void cut_field(Body& body, const Task& task, bool knows_factor, Plan& plan) {
  while (!plan.fits && plan.field_levels.details > 0) {
    --plan.field_levels.details;
    plan.work += count_field_work(body.counts.prices, plan.counts) +
                 (body.is_loaded ? count_field_work(body.counts.prices, body.loads->counts.forces) : 0);
    plan.field = planned_field_work(body, plan);
    if (!knows_factor && holds_answer(task, plan)) {
      plan_factor(body, task, plan);
      knows_factor = true;
    }
    plan.fits = knows_factor && planned_work(plan) + plan.reserve <= task.budget;
  }
}

}  // namespace

std::uint64_t plan_set_work(const ModelCounts& model, const SetCounts& set) noexcept {
  return resolve_work(model, set) + touch_work(model.prices, set) +
         find_changes_work(model.prices, model.cached_factors, set.columns);
}

std::uint64_t plan_part_work(const ModelCounts& model, const SetCounts& set) noexcept {
  const std::uint64_t loaded = model.takes_loads() ? count_field_work(model.prices, set) : 0;
  return resolve_contacts_work(model.prices, set.contacts) + loaded +
         (model.forces_only && !model.takes_loads() ? 0 : touch_work(model.prices, set));
}

Plan make_plan(Body& body, std::span<const Constraint> contacts, const Wants& wants) noexcept {
  const Task task{wants, contacts};
  const std::uint32_t finest = body.counts.levels - 1;
  const std::uint32_t coarsest = body.view->info->coarsest_constraint_level;
  Plan plan;
  plan.field_levels = {wants.finest_displaced, wants.finest_displaced};
  for (std::uint32_t c = finest + 1; !plan.fits && c-- > coarsest;) {
    plan_set(body, task, c, plan);
    const bool knows_factor = holds_answer(task, plan) || c == coarsest;
    if (knows_factor) {
      plan_factor(body, task, plan);
    }
    const auto leave_new = [&] {
      if (!plan.fits && c > coarsest && plan.wanted.exists && plan.wanted.level == c) {
        plan_without_new(body, task, plan);
      }
    };
    leave_new();
    if (wants.field && wants.keeps_level && c == finest && c > coarsest) {
      cut_field(body, task, knows_factor, plan);
      if (!knows_factor) {
        leave_new();
      }
    }
    if (!plan.fits && c == finest) {
      plan.field_levels.details = wants.finest_displaced;
    }
  }
  if (wants.field) {
    cut_field(body, task, true, plan);
  }
  return plan;
}

}  // namespace greenloop
