#include "runtime/planner.hpp"

namespace greenloop {
namespace {

// what the planner knows of a step
struct Task {
  std::span<const Contact> contacts;
  std::uint64_t budget = 0;
  bool wants_field = false;
};

// as much of the field as a plan asks for
std::uint64_t planned_field_work(const Body& body, const Plan& plan) {
  return field_work(body.counts, plan.counts, plan.field_levels,
                    count_field_blocks(body.columns, body.set, plan.field_levels.details));
}

// resolves the contacts and looks for the factor
void plan_set(Body& body, const Task& task, const Resolution& resolution, Plan& plan) {
  resolve_contacts(task.contacts, *body.view, body.facts, resolution, body.set);
  plan.resolution = resolution;
  plan.counts = {};
  plan.counts.contacts = task.contacts.size();
  plan.counts.columns = body.set.columns;
  plan.cached = body.cache.find(body.set);
  plan.work += resolve_work(body.counts, plan.counts);
  plan.factor = 0;
  plan.changes.base = nullptr;
  plan.field = task.wants_field ? planned_field_work(body, plan) : 0;
  plan.fits = false;
}

// whether the answer fits, given the factor
bool holds_answer(const Task& task, const Plan& plan) {
  return plan.work + force_work(plan.counts) + plan.field <= task.budget;
}

// touches the coefficients of the set and chooses how to make its factor
void choose_factor(Body& body, Plan& plan) {
  clear(body.touched);
  touch(body.refinement, body.set.column, body.set.columns, body.touched);
  count_factor(body.set, body.touched, body.cost, body.stored, plan.counts);
  find_changes(body.cache, body.set, plan.changes);
  plan.work += touch_work(plan.counts) + find_changes_work(body.counts.cached_factors, plan.counts.columns);
  plan.factor = factor_work(body.counts, plan.counts);
  if (plan.changes.base != nullptr) {
    const std::uint64_t update = update_factor_work(plan.counts, plan.changes, body.cost);
    plan.changes.base = update < plan.factor ? plan.changes.base : nullptr;
    plan.factor = update < plan.factor ? update : plan.factor;
  }
  plan.factor += drop_batch_work(body.pending);
}

// decides where the factor comes from; whether all fits, or else whether the set is wanted
void plan_factor(Body& body, const Task& task, Plan& plan) {
  const bool holds = holds_answer(task, plan);
  if (plan.cached == nullptr) {
    choose_factor(body, plan);
  }
  plan.fits = plan.work + force_work(plan.counts) + plan.factor + plan.field <= task.budget;
  if (!plan.fits && holds && !plan.wanted.exists) {
    plan.wanted = {true, plan.resolution, plan.counts};
  }
}

// a set in the making: `set` has sums over its columns, which bound its coefficients and visits
struct Choice {
  SetCounts set;
  std::uint64_t field_blocks = 0;

  void add(const Body& body, const Task& task, const FieldLevels& levels, std::uint32_t column) {
    const ColumnCost& cost = body.cost.of(column);
    set.columns += 1;
    set.visits += cost.visits;
    set.coefficients += cost.coefficients;
    field_blocks += task.wants_field ? column_blocks(body.columns, column, levels.details) : 0;
  }
  void remove(const Choice& other) {
    set.columns -= other.set.columns;
    set.visits -= other.set.visits;
    set.coefficients -= other.set.coefficients;
    field_blocks -= other.field_blocks;
  }
};

// whether the budget holds a choice, given its factor, and an answer without it if the factor cannot be had
bool holds_choice(const Body& body, const Task& task, const Plan& plan, const Choice& choice) {
  const std::uint64_t planning = mixture_work(body.counts, choice.set);
  const std::uint64_t field =
      task.wants_field ? field_work(body.counts, choice.set, plan.field_levels, choice.field_blocks) : 0;
  return planning + body.least_work <= task.budget &&
         plan.work + planning + force_work(choice.set) + field <= task.budget;
}

// chooses as many groups of a set as the budget holds; false if none
bool choose_groups(Body& body, const Task& task, Plan& plan) {
  Choice choice;
  choice.set.contacts = task.contacts.size();
  for (std::uint32_t k = 0; k < body.set.columns; ++k) {
    choice.add(body, task, plan.field_levels, body.set.column[k]);
  }
  if (!holds_choice(body, task, plan, choice)) {
    return false;
  }
  body.mixture.rank(task.contacts, body.set, body.facts);
  std::uint32_t chosen = 0;
  for (; chosen < body.mixture.groups(); ++chosen) {
    Choice coarse;
    coarse.add(body, task, plan.field_levels, body.mixture.column(chosen));
    Choice finer = choice;
    finer.remove(coarse);
    for (const std::uint32_t i : body.mixture.contacts_of(chosen)) {
      const std::uint32_t column = column_of(*body.view, body.facts, task.contacts[i].node, body.counts.levels - 1);
      finer.add(body, task, plan.field_levels, column);
    }
    if (!holds_choice(body, task, plan, finer)) {
      break;
    }
    choice = finer;
  }
  plan.work += Mixture::choose_work(task.contacts.size());
  body.mixture.choose(chosen, task.contacts, body.facts);
  return chosen > 0;
}

// the level's set with some groups at the finest level; if it does not fit, the level's set again
void plan_mixture(Body& body, const Task& task, Plan& plan) {
  const Resolution coarse = plan.resolution;
  if (!choose_groups(body, task, plan)) {
    return;
  }
  plan_set(body, task, {coarse.level, body.mixture.fine()}, plan);
  plan_factor(body, task, plan);
  if (!plan.fits) {
    plan_set(body, task, coarse, plan);
  }
}

}  // namespace

std::uint64_t mixture_work(const ModelCounts& model, const SetCounts& most) noexcept {
  return Mixture::choose_work(most.contacts) + 2 * resolve_work(model, most) + touch_work(most) +
         find_changes_work(model.cached_factors, most.columns);
}

Plan make_plan(Body& body, std::span<const Contact> contacts, std::uint64_t budget, bool wants_field,
               std::uint32_t finest) noexcept {
  const Task task{contacts, budget, wants_field};
  const std::uint32_t levels = body.counts.levels;
  const std::uint32_t coarsest = body.view->info->coarsest_constraint_level;
  Plan plan;
  plan.field_levels = {finest, finest};
  for (std::uint32_t c = levels; !plan.fits && c-- > coarsest;) {
    plan_set(body, task, {c}, plan);
    const bool holds = holds_answer(task, plan);
    if (holds && !plan.wanted.exists && c + 1 < levels) {
      plan_mixture(body, task, plan);
    }
    if (!plan.fits && (holds || c == coarsest)) {
      plan_factor(body, task, plan);
    }
  }
  while (!plan.fits && wants_field && plan.field_levels.details > 0) {
    --plan.field_levels.details;
    plan.work += count_field_work(plan.counts);
    plan.field = planned_field_work(body, plan);
    plan.fits = plan.work + force_work(plan.counts) + plan.factor + plan.field <= budget;
  }
  return plan;
}

}  // namespace greenloop
