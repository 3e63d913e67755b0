#include "runtime/requirement.hpp"

#include "runtime/domain.hpp"
#include "runtime/field.hpp"
#include "runtime/support.hpp"

namespace greenloop {
namespace {

// byte offsets of nodes are kept in 32 bits
constexpr std::uint32_t most_nodes = 0xffffffff / sizeof(Float4);

void raise(std::uint32_t& bound, std::uint32_t value) { bound = value > bound ? value : bound; }

void count_model(const ModelView& view, const Limits& limits, BodySizes& sizes) {
  ModelCounts& counts = sizes.counts;
  counts.nodes = view.node_count;
  counts.levels = view.levels;
  counts.max_contacts = limits.max_contacts;
  counts.cached_factors = limits.cached_factors;
  std::uint64_t records = 0;
  std::uint64_t averages = 0;
  const std::uint64_t odd = view.domain_count - view.level[0].counts->domain_count;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    if (q > 0) {
      const LiftingCounts lifting = count_lifting(view, q);
      sizes.most_neighbours[q] = lifting.most_neighbours;
      sizes.lifting_records[q] = lifting.records;
    }
    records += sizes.lifting_records[q];
    averages += q > 0 && q <= sizes.coefficients.last_averages ? domain_up_to(view, q) : 0;
    counts.rows[q] = domain_up_to(view, q) + averages;
    counts.transform_work[q] = inverse_transform_work(records, odd, averages);
  }
}

}  // namespace

bool in_range(const Limits& limits) noexcept {
  return limits.max_contacts >= 1 && limits.max_contacts <= 4096 && limits.cached_factors >= 1 &&
         limits.cached_factors <= 1024;
}

void measure_body(const ModelView& view, const Limits& limits, BodySizes& sizes, Requirement& requirement) noexcept {
  if (!in_range(limits) || view.node_count > most_nodes) {
    return;
  }
  sizes.coefficients = number_coefficients(view);
  count_model(view, limits, sizes);
  sizes.set_columns = view.domain_count < limits.max_contacts ? view.domain_count : limits.max_contacts;
  LongestLists longest[Couplings::most];
  CouplingSection section;
  for (std::uint32_t s = 0; s < Couplings::most; ++s) {
    if (find_section(view, s, section)) {
      ++sizes.counts.sections;
      longest[s] = longest_lists(section);
      raise(sizes.longest_list, longest[s].direct);
    }
  }
  std::uint64_t plans = check_contacts_work(limits.max_contacts);
  for (std::uint32_t c = view.levels; c-- > view.info->coarsest_constraint_level;) {
    const ReachBound reach = bound_reach(view, c, sizes.most_neighbours);
    if (!reach.bounded) {
      return;
    }
    const SetCounts most = most_counts(view, sizes.coefficients, longest, c, limits.max_contacts, reach);
    const std::uint64_t functional = most.columns > 0 ? most.column_coefficients / most.columns : 0;
    sizes.functional = functional > sizes.functional ? functional : sizes.functional;
    plans += plan_work(sizes.counts, most);
    const std::uint64_t forces = factor_work(sizes.counts, most) + force_work(most);
    requirement.worst_work[c] = plans + forces + field_work(sizes.counts, most, whole_field_level(c, view.levels));
    // the coarsest level comes last
    requirement.least_work = plans + forces + field_work(sizes.counts, most, 0);
  }
  sizes.supported = true;
}

}  // namespace greenloop
