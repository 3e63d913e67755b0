#include "runtime/elastostatic/requirement.hpp"

#include <algorithm>

#include "runtime/elastostatic/known_forces.hpp"
#include "runtime/elastostatic/mixed_contacts.hpp"
#include "runtime/elastostatic/planner.hpp"
#include "runtime/elastostatic/unilateral.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/point_support.hpp"

namespace greenloop {
namespace {

// byte offsets of nodes are kept in 32 bits
constexpr std::uint32_t most_nodes = 0xffffffff / sizeof(Float4);

void count_model(const ModelView& view, const Elastostatic::Limits& limits, BodySizes& sizes) {
  ModelCounts& counts = sizes.counts;
  counts.levels = view.levels;
  counts.max_contacts = limits.max_contacts;
  counts.cached_factors = limits.cached_factors;
  counts.glide_cycles = limits.glide_cycles;
  counts.refining_work = limits.refining_work;
  counts.prices = limits.prices;
  counts.prediction = prediction_of(view);
  counts.forces_only = limits.forces_only;
  counts.max_forces = limits.max_forces;
  counts.max_points = limits.max_points;
  counts.model_loads = limits.model_loads ? static_cast<std::uint32_t>(view.loads.size()) : 0;
  counts.iterations = limits.iterations;
  counts.mixed_contacts = limits.mixed_contacts;
  counts.keeps_capacitance = limits.keep_capacitance || limits.iterations > 0 || limits.mixed_contacts;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    if (q > 0) {
      sizes.lifting[q] = count_lifting(view, q);
    }
    counts.nodes[q] = nodes_up_to(view, q);
    counts.rows[q] = domain_up_to(view, q);
  }
}

std::uint64_t larger(std::uint64_t a, std::uint64_t b) { return a > b ? a : b; }

std::uint64_t smaller(std::uint64_t a, std::uint64_t b) { return a < b ? a : b; }

// most distinct nodes that `most` contacts or forces are on
std::uint32_t most_touched(const ModelView& view, std::uint32_t most) {
  std::uint32_t touchable = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    touchable += static_cast<std::uint32_t>(
        std::count_if(level.nodes, level.nodes + level.counts->node_count,
                      [](const layout::NodeRecord& node) { return (node.flags & layout::node_touchable) != 0; }));
  }
  return std::min(touchable, most);
}

// most coefficients of a column
std::uint64_t functional_of(const ModelView& view, const ReachBound& reach) {
  std::uint64_t functional = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    functional += smaller(view.level[q].counts->domain_count, reach.coefficients[q]);
  }
  return functional;
}

// of checking constraints, and of listing the known forces among them
std::uint64_t check_work(const Elastostatic::Limits& limits, const ModelCounts& counts) {
  const std::uint64_t constraints = std::uint64_t{limits.max_contacts} + limits.max_forces;
  const std::uint64_t unilateral =
      limits.iterations > 0 ? list_unilateral_work(counts.prices, limits.max_contacts, limits.max_contacts) : 0;
  const std::uint64_t mixed =
      limits.mixed_contacts ? list_mixed_work(counts.prices, constraints, limits.max_contacts) : 0;
  const bool loaded = counts.takes_loads() || limits.max_points > 0;
  return larger(unilateral, mixed) + (loaded || limits.iterations > 0 || limits.mixed_contacts
                                          ? check_loaded_work(counts.prices, constraints, limits.max_forces)
                                          : check_contacts_work(counts.prices, constraints));
}

// of holds, mixed contacts and unilateral ones, whichever is more
std::uint64_t most_force_work(const ModelCounts& counts, SetCounts set, std::uint32_t iterations) {
  std::uint64_t most = force_work(counts.prices, set);
  set.corners = counts.max_contacts;
  if (counts.mixed_contacts) {
    set.rows = std::uint64_t{3} * counts.max_contacts;
    most = larger(most, force_work(counts.prices, set));
  }
  if (iterations > 0) {
    set.rows = 0;
    set.iterations = iterations;
    most = larger(most, force_work(counts.prices, set));
  }
  return most;
}

// of a body at rest, surfaces that touch nothing that moves among its constraints
std::uint64_t rest_work(const Elastostatic::Limits& limits, const ModelCounts& counts, const SetCounts& set) {
  const std::uint64_t field = limits.forces_only ? 0 : rest_field_work(counts.prices, counts.nodes[counts.levels - 1]);
  return check_work(limits, counts) + most_force_work(counts, set, least_iterations(limits.iterations)) + field;
}

// by constraint level
struct MostOf {
  const MostCounts* contacts;
  const MostCounts* forces;  ///< empty ones where no forces are known
};

void bound_work(const ModelView& view, const Elastostatic::Limits& limits, const MostOf& most_of,
                const BodySizes& sizes, Elastostatic::Requirement& requirement) {
  const ModelCounts& counts = sizes.counts;
  const std::uint32_t finest = view.levels - 1;
  const std::uint32_t coarsest = view.info->coarsest_constraint_level;
  const auto loads = [&](std::uint32_t c) -> LoadCounts {
    return {most_of.forces[c].set, counts.model_loads, most_of.contacts[c].set.stored};
  };
  const auto field = [&](std::uint32_t c, std::uint32_t details) {
    const auto blocks = [&](const MostCounts& most) {
      return details == 0 && finest > 0 ? most.least_field_blocks : most.field_blocks;
    };
    const std::uint64_t of_loads =
        counts.takes_loads() ? load_field_work(counts, loads(c), details, blocks(most_of.forces[c])) : 0;
    const MostCounts& most = most_of.contacts[c];
    return limits.forces_only ? 0 : field_work(counts, most.set, {finest, details}, blocks(most)) + of_loads;
  };
  const std::uint64_t checking = check_work(limits, counts);
  const std::uint64_t older = limits.glide_cycles > 1 ? older_forces_work(counts, sizes.set_columns) : 0;
  std::uint64_t dropped = 0;
  for (std::uint32_t c = coarsest; c < view.levels; ++c) {
    dropped = larger(dropped, priced(most_of.contacts[c].set.coefficients, counts.prices.dropped));
  }
  std::uint64_t planned = checking;
  std::uint64_t part = 0;  // planning what a factor at hand has of a finer set, once in a step
  std::uint64_t finer_answer = 0;
  std::uint64_t least_answer = ~std::uint64_t{0};
  for (std::uint32_t c = view.levels; c-- > coarsest;) {
    const SetCounts& most = most_of.contacts[c].set;
    const std::uint64_t cuts =
        finest * (count_field_work(counts.prices, most) + count_field_work(counts.prices, most_of.forces[c].set));
    // details of the field go before the finest level does, where surfaces touch
    planned += c == finest && limits.iterations > 0 ? cuts : 0;
    planned += plan_set_work(counts, most) + (counts.takes_loads() ? plan_loads_work(counts, most, loads(c)) : 0);
    const std::uint64_t displaced =
        counts.takes_loads() ? displace_by_loads_work(counts, most, loads(c), most_coupling_blocks(most, loads(c))) : 0;
    const std::uint64_t factors = planned + part + dropped + displaced + factor_work(counts, most);
    const std::uint64_t forces = factors + most_force_work(counts, most, least_iterations(limits.iterations));
    const std::uint64_t answer = factors + most_force_work(counts, most, limits.iterations) + field(c, finest);
    if (c == finest) {
      requirement.worst_work[c] = answer + older;
    } else {
      // the budget of such a step did not hold an answer of the next finer level; what is not the answer's is bounded
      // by refining_work, too. Where contacts wait it did not hold the whole answer of this level
      const std::uint64_t refining = checking + smaller(limits.refining_work, finer_answer);
      requirement.worst_work[c] = smaller(finer_answer, larger(answer, refining) + older);
    }
    // with few contacts a finer level may take less than planning it and answering at a coarser one
    least_answer = smaller(least_answer, forces + field(c, finest));
    requirement.least_work = smaller(least_answer, forces + cuts + field(c, 0));
    part = limits.glide_cycles > 1 ? larger(part, plan_part_work(counts, most)) : 0;
    finer_answer = answer;
  }
  const std::uint64_t rest = rest_work(limits, counts, most_of.contacts[finest].set);
  requirement.worst_work[finest] = larger(requirement.worst_work[finest], rest);
  requirement.least_work = larger(requirement.least_work, rest);
}

// columns of two sets, which may have none in common
SetCounts both(const SetCounts& a, const SetCounts& b) {
  SetCounts sum;
  sum.columns = a.columns + b.columns;
  sum.coefficients = a.coefficients + b.coefficients;
  sum.visits = a.visits + b.visits;
  sum.stored = a.stored + b.stored;
  return sum;
}

// of a call of `displacements`, forces resolved at any level, or of `masked_compliance`, at the finest
std::uint64_t bound_selected(const ModelView& view, const MostOf& most_of, const ReachBound& reach,
                             const BodySizes& sizes) {
  const ModelCounts& counts = sizes.counts;
  const SetCounts points = most_point_counts(view, std::uint64_t{3} * counts.max_points, reach, sizes.lifting);
  const SetCounts node = most_point_counts(view, 1, reach, sizes.lifting);
  const auto work = [&](const SetCounts& moved, const SetCounts& forces, std::uint64_t times) {
    const LoadCounts loads{forces, counts.model_loads, moved.stored};
    return ask_work(counts, moved, loads) +
           times * displace_by_loads_work(counts, moved, loads, most_coupling_blocks(moved, loads));
  };
  std::uint64_t most = 0;
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    most = larger(most, work(points, both(most_of.contacts[c].set, most_of.forces[c].set), 1));
  }
  const std::uint32_t finest = view.levels - 1;
  return larger(most, work(node, both(most_of.contacts[finest].set, most_of.forces[finest].set), 3));
}

}  // namespace

bool in_range(const Elastostatic::Limits& limits) noexcept {
  return limits.max_contacts >= 1 && limits.max_contacts <= 4096 && limits.cached_factors >= 1 &&
         limits.cached_factors <= 1024 && limits.glide_cycles >= 1 && limits.glide_cycles <= 256 &&
         limits.max_forces <= 4096 && limits.max_points <= 4096 && limits.iterations <= 1024 &&
         (limits.iterations == 0 || limits.max_contacts <= ContactProblem::most_candidates);
}

void measure_body(const ModelView& view, const Elastostatic::Limits& limits, BodySizes& sizes,
                  Elastostatic::Requirement& requirement) noexcept {
  if (!in_range(limits) || view.problem != layout::Problem::elastostatic || view.node_count > most_nodes) {
    return;
  }
  const CouplingCounts couplings = count_couplings(view);
  if (!couplings.countable) {
    return;
  }
  count_model(view, limits, sizes);
  sizes.longest_column = couplings.longest_column;
  sizes.set_columns = view.domain_count < limits.max_contacts ? view.domain_count : limits.max_contacts;
  Arena counting;
  BaseColumnsMaker<3> base;
  base.carve(counting, view);
  MostCounts most_of[layout::max_levels];
  MostCounts most_forces[layout::max_levels];
  const std::uint32_t contacts = most_touched(view, limits.max_contacts);
  const std::uint32_t forced = most_touched(view, limits.max_forces);
  for (std::uint32_t c = view.levels; c-- > view.info->coarsest_constraint_level;) {
    const ReachBound reach = bound_reach(view, c, sizes.lifting);
    if (!reach.bounded) {
      return;
    }
    sizes.functional = larger(sizes.functional, functional_of(view, reach));
    const ColumnBounds bounds = bound_columns(view, c, contacts, sizes.lifting);
    most_of[c] = most_counts(view, c, contacts, bounds, sizes.lifting);
    if (forced > 0) {
      const ColumnBounds of_forces = bound_columns(view, c, forced, sizes.lifting);
      most_forces[c] = most_force_counts(view, c, sizes.counts, of_forces, sizes.lifting);
    }
  }
  add_blocks(view, base.columns(), most_of);
  if (forced > 0) {
    add_blocks(view, base.columns(), most_forces);
  }
  const std::uint64_t entries = sizes.set_columns * sizes.functional;
  sizes.slots = (entries < view.domain_count ? entries : view.domain_count) + sizes.set_columns;
  sizes.counts.capacitance_room = capacitance_room(sizes.slots, sizes.set_columns);
  bound_work(view, limits, {most_of, most_forces}, sizes, requirement);
  if (limits.max_points > 0) {
    const ReachBound reach = bound_reach(view, view.levels - 1, sizes.lifting);
    requirement.selected_work = bound_selected(view, {most_of, most_forces}, reach, sizes);
  }
  sizes.supported = true;
}

}  // namespace greenloop
