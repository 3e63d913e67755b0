#include "runtime/elastostatic/requirement.hpp"

#include "runtime/elastostatic/planner.hpp"
#include "runtime/factor/factor_job.hpp"
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
  counts.keeps_capacitance = limits.keep_capacitance;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    if (q > 0) {
      sizes.most_neighbours[q] = count_lifting(view, q).most_neighbours;
    }
    counts.nodes[q] = nodes_up_to(view, q);
    counts.rows[q] = domain_up_to(view, q);
  }
}

std::uint64_t larger(std::uint64_t a, std::uint64_t b) { return a > b ? a : b; }

// the dearest that a step may have done before and after it is answered, over the levels looked at
struct OtherWork {
  std::uint64_t plans = 0;    // of the sets
  std::uint64_t part = 0;     // planning what a factor at hand has of one of them
  std::uint64_t dropped = 0;  // batch of a finer set
  std::uint64_t older = 0;    // forces of the level before
  std::uint64_t slices = 0;   // of the factor of a set as fine or finer
};

// a step's work with what it may spend on a factor for the next
std::uint64_t with_slices(std::uint64_t answer, std::uint64_t slices, std::uint64_t refining_work) {
  const std::uint64_t whole = answer + slices;
  return larger(answer, whole < refining_work ? whole : refining_work);
}

// planning a set of some level, and giving a batch of it up
void add_set(const ModelCounts& model, const SetCounts& most, OtherWork& other) {
  other.plans += plan_set_work(model, most);
  other.dropped = larger(other.dropped, priced(most.coefficients, model.prices.dropped));
}

void add_slices(const ModelCounts& model, const SetCounts& most, OtherWork& other) {
  const std::uint64_t slice = resolve_contacts_work(model.prices, most.contacts) + most_slice_work(model, most) +
                              other.dropped + force_work(model.prices, most);
  other.slices = larger(other.slices, slice);
}

// forces of a set with a fresh factor
std::uint64_t fresh_forces_work(const ModelCounts& model, const SetCounts& most, const OtherWork& other) {
  return other.dropped + factor_work(model, most) + force_work(model.prices, most);
}

void bound_work(const ModelView& view, const Elastostatic::Limits& limits, const MostCounts* most_of,
                const BodySizes& sizes, Elastostatic::Requirement& requirement) {
  const ModelCounts& counts = sizes.counts;
  const std::uint32_t finest = view.levels - 1;
  const auto field = [&](const MostCounts& most, std::uint32_t field_level) {
    const std::uint64_t blocks = most.field_blocks[field_level];
    return limits.forces_only ? 0 : field_work(counts, most.set, {finest, field_level}, blocks);
  };
  OtherWork other;
  other.plans = check_contacts_work(counts.prices, limits.max_contacts);
  other.older = limits.glide_cycles > 1 ? older_forces_work(counts, sizes.set_columns) : 0;
  for (std::uint32_t c = view.levels; c-- > view.info->coarsest_constraint_level;) {
    const SetCounts& most = most_of[c].set;
    add_set(counts, most, other);
    // at the coarsest level the field is cut as well
    const bool coarsest = c == view.info->coarsest_constraint_level;
    const std::uint64_t cuts = coarsest ? finest * count_field_work(counts.prices, most) : 0;
    const std::uint64_t planning = other.plans + other.part + cuts;
    const std::uint64_t forces = planning + fresh_forces_work(counts, most, other);
    std::uint64_t answer = with_slices(forces + field(most_of[c], finest), other.slices, limits.refining_work);
    add_slices(counts, most, other);
    if (!coarsest && limits.glide_cycles > 1) {  // where contacts wait, slices make the factor
      other.part = larger(other.part, plan_part_work(counts, most));
      const std::uint64_t known =
          other.plans + other.part + force_work(counts.prices, most) + field(most_of[c], finest);
      answer = larger(answer, with_slices(known, other.slices, limits.refining_work));
    }
    requirement.worst_work[c] = answer + other.older;
    requirement.least_work = forces + field(most_of[c], 0);
  }
}

}  // namespace

bool in_range(const Elastostatic::Limits& limits) noexcept {
  return limits.max_contacts >= 1 && limits.max_contacts <= 4096 && limits.cached_factors >= 1 &&
         limits.cached_factors <= 1024 && limits.glide_cycles >= 1 && limits.glide_cycles <= 256;
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
  for (std::uint32_t c = view.levels; c-- > view.info->coarsest_constraint_level;) {
    const ReachBound reach = bound_reach(view, c, sizes.most_neighbours);
    if (!reach.bounded) {
      return;
    }
    most_of[c] = most_counts(view, couplings, c, limits.max_contacts, reach, base.columns());
    const SetCounts& most = most_of[c].set;
    const std::uint64_t functional = most.columns > 0 ? most.column.coefficients / most.columns : 0;
    sizes.functional = larger(sizes.functional, functional);
  }
  const std::uint64_t entries = sizes.set_columns * sizes.functional;
  sizes.slots = (entries < view.domain_count ? entries : view.domain_count) + sizes.set_columns;
  sizes.counts.capacitance_room = capacitance_room(sizes.slots, sizes.set_columns);
  bound_work(view, limits, most_of, sizes, requirement);
  sizes.supported = true;
}

}  // namespace greenloop
