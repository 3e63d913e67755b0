#include "runtime/requirement.hpp"

#include "runtime/domain.hpp"
#include "runtime/factor_update.hpp"
#include "runtime/pending_factor.hpp"
#include "runtime/sparse_forces.hpp"
#include "runtime/support.hpp"

namespace greenloop {
namespace {

// byte offsets of nodes are kept in 32 bits
constexpr std::uint32_t most_nodes = 0xffffffff / sizeof(Float4);
constexpr std::uint64_t most_field_blocks_of_a_model = std::uint64_t{1} << 30;

void count_model(const ModelView& view, const Limits& limits, BodySizes& sizes) {
  ModelCounts& counts = sizes.counts;
  counts.levels = view.levels;
  counts.max_contacts = limits.max_contacts;
  counts.cached_factors = limits.cached_factors;
  counts.glide_cycles = limits.glide_cycles;
  counts.refining_work = limits.refining_work;
  counts.butterfly = has_stencils(view);
  counts.forces_only = limits.forces_only;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    if (q > 0) {
      sizes.most_neighbours[q] = count_lifting(view, q).most_neighbours;
    }
    counts.nodes[q] = nodes_up_to(view, q);
    counts.rows[q] = domain_up_to(view, q);
  }
}

// a step's work with what it may spend on the factor of a finer level
std::uint64_t with_refining(std::uint64_t answer, std::uint64_t finer_factor, std::uint64_t refining_work) {
  const std::uint64_t whole = answer + finer_factor;
  const std::uint64_t refined = whole < refining_work ? whole : refining_work;
  return answer > refined ? answer : refined;
}

}  // namespace

bool in_range(const Limits& limits) noexcept {
  return limits.max_contacts >= 1 && limits.max_contacts <= 4096 && limits.cached_factors >= 1 &&
         limits.cached_factors <= 1024 && limits.glide_cycles >= 1 && limits.glide_cycles <= 256;
}

void measure_body(const ModelView& view, const Limits& limits, BodySizes& sizes, Requirement& requirement) noexcept {
  const std::uint64_t field_blocks = view.level[view.levels - 1].counts->field_blocks;
  if (!in_range(limits) || view.node_count > most_nodes || field_blocks > most_field_blocks_of_a_model) {
    return;
  }
  const CouplingCounts couplings = count_couplings(view);
  if (!couplings.countable) {
    return;
  }
  count_model(view, limits, sizes);
  sizes.longest_column = couplings.longest_column;
  sizes.set_columns = view.domain_count < limits.max_contacts ? view.domain_count : limits.max_contacts;
  SetCounts most_of[layout::max_levels];
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    const ReachBound reach = bound_reach(view, c, sizes.most_neighbours);
    if (!reach.bounded) {
      return;
    }
    most_of[c] = most_counts(view, couplings, c, limits.max_contacts, reach);
    const std::uint64_t functional = most_of[c].columns > 0 ? most_of[c].column_coefficients / most_of[c].columns : 0;
    sizes.functional = functional > sizes.functional ? functional : sizes.functional;
  }
  const std::uint64_t entries = sizes.set_columns * sizes.functional;
  sizes.slots = entries < view.domain_count ? entries : view.domain_count;
  sizes.counts.capacitance_room =
      sizes.slots *
      pairs(sizes.set_columns < CapacitanceScratch::batch ? sizes.set_columns : CapacitanceScratch::batch);
  const std::uint32_t finest = view.levels - 1;
  std::uint64_t dropped = 0;       // batch of a finer level
  std::uint64_t finer_factor = 0;  // of a finer level, that the rest of a budget is spent on
  const std::uint64_t older = limits.glide_cycles > 1 ? older_forces_work(sizes.counts, sizes.set_columns) : 0;
  std::uint64_t plans = check_contacts_work(limits.max_contacts);
  for (std::uint32_t c = view.levels; c-- > view.info->coarsest_constraint_level;) {
    const SetCounts& most = most_of[c];
    const auto field = [&](std::uint32_t field_level) {
      const std::uint64_t blocks = most_field_blocks(view, most.columns, field_level);
      return limits.forces_only ? 0 : field_work(sizes.counts, most, {finest, field_level}, blocks);
    };
    plans +=
        resolve_work(sizes.counts, most) + touch_work(most) + find_changes_work(limits.cached_factors, most.columns);
    dropped = 2 * most.coefficients > dropped ? 2 * most.coefficients : dropped;
    const std::uint64_t forces = dropped + factor_work(sizes.counts, most) + force_work(most);
    // at the coarsest level the field is cut as well
    const std::uint64_t cuts = c == view.info->coarsest_constraint_level ? finest * count_field_work(most) : 0;
    const std::uint64_t answer = plans + cuts + forces + field(finest) + older;
    requirement.worst_work[c] = with_refining(answer, finer_factor, limits.refining_work);
    requirement.least_work = plans + cuts + forces + field(0);
    const std::uint64_t slice =
        resolve_contacts_work(limits.max_contacts) + most_slice_work(sizes.counts, most) + dropped;
    finer_factor = slice > finer_factor ? slice : finer_factor;
  }
  sizes.supported = true;
}

}  // namespace greenloop
