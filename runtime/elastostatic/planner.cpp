#include "runtime/elastostatic/planner.hpp"

namespace greenloop {
namespace {

// what the planner knows of a step
struct Task {
  std::span<const Constraint> contacts;
  std::uint64_t budget = 0;
  bool wants_field = false;
};

// as much of the field as a plan asks for
std::uint64_t planned_field_work(const Body& body, const Plan& plan) {
  return field_work(body.counts, plan.counts, plan.field_levels,
                    count_field_blocks(body.field_blocks, body.touched, plan.field_levels.details));
}

// touches the coefficients of the set
void touch_set(Body& body, Plan& plan) {
  clear(body.touched);
  touch(body.refinement, body.planned.column, body.planned.columns, body.touched);
  plan.counts.coefficients = body.touched.coefficients();
  plan.counts.visits = body.touched.visits;
  plan.work += touch_work(body.counts.prices, plan.counts);
}

// resolves the contacts, looks for the factor, and touches the coefficients unless only forces by a cached one are
// wanted
void plan_set(Body& body, const Task& task, const Resolution& resolution, Plan& plan) {
  resolve_contacts(task.contacts, *body.view, body.facts, resolution, body.resolution, body.planned);
  plan.resolution = resolution;
  plan.counts = {};
  plan.counts.contacts = task.contacts.size();
  plan.counts.columns = body.planned.columns;
  plan.cached = body.cache.find(body.planned.all());
  plan.work += resolve_work(body.counts, plan.counts);
  plan.factor = 0;
  plan.update = false;
  if (task.wants_field || plan.cached == nullptr) {
    touch_set(body, plan);
  }
  plan.field = task.wants_field ? planned_field_work(body, plan) : 0;
  plan.fits = false;
}

// whether the answer fits, given the factor
bool holds_answer(const Body& body, const Task& task, const Plan& plan) {
  return plan.work + force_work(body.counts.prices, plan.counts) + plan.field <= task.budget;
}

// chooses how to make the factor of the set
void choose_factor(Body& body, Plan& plan) {
  count_factor(body.planned.all(), body.touched, body.cost, body.stored, plan.counts);
  find_changes(body.cache, body.planned.all(), body.changes);
  plan.work += find_changes_work(body.counts.prices, body.counts.cached_factors, plan.counts.columns);
  plan.factor = factor_work(body.counts, plan.counts);
  plan.bounded = factor_bounded_work(body.counts, plan.counts);
  if (body.changes.base != nullptr) {
    const ChangeCounts changes = count_changes(body.changes, body.cost);
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
std::uint64_t planned_work(const Body& body, const Plan& plan) {
  return plan.work + force_work(body.counts.prices, plan.counts) + plan.factor + plan.field;
}

// decides where the factor comes from; whether all fits, or else whether the level is wanted
void plan_factor(Body& body, const Task& task, Plan& plan) {
  const bool holds = holds_answer(body, task, plan);
  if (plan.cached == nullptr) {
    choose_factor(body, plan);
  }
  plan.fits = planned_work(body, plan) <= task.budget;
  if (!plan.fits && holds && !plan.wanted.exists) {
    plan.wanted = {true, plan.resolution.level, plan.counts, plan.field};
  }
}

// what a mixed set may cost
struct Room {
  std::uint64_t budget = 0;    // for all of it
  std::uint64_t planning = 0;  // for nothing but planning: the rest is the coarser answer's
  std::uint64_t field = 0;     // at most: a mixture touches what the coarser set or the finest touches
  std::uint32_t entering = 0;  // contacts that enter a factor
  bool grows = false;          // whether groups may be added to those of the last choice
};

// work of changing a factor of the set by as many nodes as enter and leave
std::uint64_t change_work(const ModelCounts& model, const SetCounts& set, std::uint64_t nodes) {
  const auto share = [&](std::uint64_t sum) { return nodes * sum / set.columns; };
  const ColumnSums entering{share(set.column.coefficients), share(set.column.blocks), share(set.column.visits)};
  return update_factor_work(model, set, {nodes, nodes, entering});
}

// most contacts that can enter a factor of about as many coefficients as the finest set has
std::uint32_t most_entering(const ModelCounts& model, const Plan& plan, std::uint64_t budget) {
  const SetCounts& whole = plan.wanted.counts;
  std::uint32_t entering = FactorChanges::most;
  for (; entering > 0; entering /= 2) {
    const std::uint64_t factor = change_work(model, whole, entering);
    if (plan.work + factor + force_work(model.prices, whole) + plan.field <= budget) {
      break;
    }
  }
  return entering;
}

Room room_for_mixture(const Body& body, const Task& task, const Plan& plan, bool contacts_stay) {
  const std::uint64_t coarser = planned_work(body, plan) + plan_set_work(body.counts, plan.counts);
  const std::uint64_t refining = body.counts.refining_work;
  Room room;
  room.budget = task.budget < refining ? task.budget : refining;
  room.planning = coarser < task.budget ? task.budget - coarser : 0;
  room.field = plan.field + plan.wanted.field;
  room.entering = contacts_stay ? 0 : most_entering(body.counts, plan, room.budget);
  room.grows = !contacts_stay && !body.glide.under_way();
  return room;
}

// a mixed set in the making: `set` has sums over its columns, which bound its coefficients and visits
struct Choice {
  SetCounts set;
  std::uint32_t entering = 0;

  void add(const Body& body, std::uint32_t column) {
    const ColumnCost& cost = body.cost.of(column);
    set.columns += 1;
    set.visits += cost.visits;
    set.coefficients += cost.coefficients;
  }
  void remove(const Choice& other) {
    set.columns -= other.set.columns;
    set.visits -= other.set.visits;
    set.coefficients -= other.set.coefficients;
  }
};

// whether the room holds a choice, given its factor
bool holds(const Body& body, const Plan& plan, const Room& room, const Choice& choice) {
  const std::uint64_t planning = mixture_work(body.counts, choice.set);
  return choice.entering <= room.entering && planning <= room.planning &&
         plan.work + planning + force_work(body.counts.prices, choice.set) + room.field <= room.budget;
}

// a choice with one more group
Choice with_group(const Body& body, const Task& task, std::uint32_t g, Choice choice) {
  Choice coarse;
  coarse.add(body, body.mixture.column(g));
  choice.remove(coarse);
  for (const std::uint32_t i : body.mixture.contacts_of(g)) {
    const std::uint32_t node = task.contacts[i].node;
    choice.add(body, column_of(*body.view, body.facts, node, body.counts.levels - 1));
    choice.entering += body.facts[node].fine ? 0 : 1;
  }
  return choice;
}

// chooses groups of a coarser set in their order, each that the room still holds; false if none
bool choose_groups(Body& body, const Task& task, const Room& room, Plan& plan) {
  Choice choice;
  choice.set.contacts = task.contacts.size();
  for (std::uint32_t k = 0; k < body.planned.columns; ++k) {
    choice.add(body, body.planned.column[k]);
  }
  if ((!room.grows && !body.mixture.has_last()) || !holds(body, plan, room, choice)) {
    return false;
  }
  plan.work += Mixture::choose_work(body.counts.prices, task.contacts.size());
  body.mixture.rank(task.contacts, body.planned, body.facts, body.last);
  bool chosen = false;
  for (std::uint32_t g = 0; g < body.mixture.groups(); ++g) {
    const Choice finer = with_group(body, task, g, choice);
    if ((room.grows || body.mixture.was_chosen(g)) && holds(body, plan, room, finer)) {
      body.mixture.choose(g);
      choice = finer;
      chosen = true;
    }
  }
  return chosen;
}

// of ranking the groups of a set, and of resolving it twice
std::uint64_t least_planning_work(const ModelCounts& model, std::uint64_t contacts) {
  SetCounts set;
  set.contacts = set.columns = contacts;
  return Mixture::choose_work(model.prices, contacts) + 2 * resolve_work(model, set);
}

// puts contacts of a coarser set to the finest level if that fits as well
void refine(Body& body, const Task& task, Plan& plan) {
  // contacts that stay reach the finest level sooner by slices: they keep the mixture that they have
  const bool contacts_stay = body.last.stays(task.contacts);
  if ((contacts_stay || body.glide.under_way()) && !body.mixture.has_last()) {
    return;
  }
  const Room room = room_for_mixture(body, task, plan, contacts_stay);
  const Resolution coarser = plan.resolution;
  // the factor of the last mixture is one of its level, which may be finer
  const bool finer = body.mixture.has_last() && body.mixture.last_level() > coarser.level;
  const std::uint32_t level = finer ? body.mixture.last_level() : coarser.level;
  if (least_planning_work(body.counts, task.contacts.size()) > room.planning) {
    return;
  }
  if (level != coarser.level) {
    plan_set(body, task, {level}, plan);
  }
  const bool chosen = choose_groups(body, task, room, plan);
  bool fits = false;
  if (chosen) {
    plan_set(body, task, {level, body.mixture.fine()}, plan);
    plan_factor(body, task, plan);
    // where no factor is near, slices of the finest one are worth more than a fresh one of a mixture
    fits = planned_work(body, plan) <= room.budget && (plan.cached != nullptr || body.changes.base != nullptr);
  }
  body.mixture.remember(fits, level, task.contacts, body.facts);
  if (!fits && (chosen || level != coarser.level)) {
    plan_set(body, task, coarser, plan);
    plan_factor(body, task, plan);
  }
}

}  // namespace

std::uint64_t plan_set_work(const ModelCounts& model, const SetCounts& set) noexcept {
  return resolve_work(model, set) + touch_work(model.prices, set) +
         find_changes_work(model.prices, model.cached_factors, set.columns);
}

std::uint64_t most_change_work(const ModelCounts& model, const SetCounts& most) noexcept {
  const std::uint64_t fresh = factor_work(model, most);
  const std::uint64_t change =
      change_work(model, most, most.columns < FactorChanges::most ? most.columns : FactorChanges::most);
  return change < fresh ? change : fresh;
}

std::uint64_t mixture_work(const ModelCounts& model, const SetCounts& set) noexcept {
  return Mixture::choose_work(model.prices, set.contacts) + resolve_work(model, set) + plan_set_work(model, set);
}

Plan make_plan(Body& body, std::span<const Constraint> contacts, std::uint64_t budget, bool wants_field,
               std::uint32_t finest_displaced) noexcept {
  const Task task{contacts, budget, wants_field};
  const std::uint32_t finest = body.counts.levels - 1;
  const std::uint32_t coarsest = body.view->info->coarsest_constraint_level;
  Plan plan;
  plan.field_levels = {finest_displaced, finest_displaced};
  for (std::uint32_t c = finest + 1; !plan.fits && c-- > coarsest;) {
    plan_set(body, task, {c}, plan);
    if (holds_answer(body, task, plan) || c == coarsest) {
      plan_factor(body, task, plan);
    }
  }
  if (body.counts.mixtures && plan.fits && plan.wanted.exists && plan.wanted.level == finest &&
      body.last.persists(contacts)) {
    refine(body, task, plan);
  }
  while (!plan.fits && wants_field && plan.field_levels.details > 0) {
    --plan.field_levels.details;
    plan.work += count_field_work(body.counts.prices, plan.counts);
    plan.field = planned_field_work(body, plan);
    plan.fits = planned_work(body, plan) <= budget;
  }
  return plan;
}

}  // namespace greenloop
