#include "runtime/requirement.hpp"

#include "runtime/point_functional.hpp"

namespace greenloop {
namespace {

// byte offsets of nodes are kept in 32 bits
constexpr std::uint32_t most_nodes = 0xffffffff / sizeof(Float4);

std::uint32_t larger(std::uint32_t a, std::uint32_t b) { return a > b ? a : b; }

// longest point functional over the columns of a level; 0 if one cannot be bounded
std::uint32_t bound_functionals(const ModelView& view, std::uint32_t constraint_level,
                                const std::uint32_t* most_neighbours) {
  const LevelView& level = view.level[constraint_level];
  std::uint32_t longest = 0;
  for (std::uint32_t j = 0; j < level.counts->column_count; ++j) {
    const std::uint32_t bound = point_functional_bound(view, most_neighbours, level.columns[j].node);
    if (bound == 0) {
      return 0;
    }
    longest = larger(longest, bound);
  }
  return longest;
}

}  // namespace

bool in_range(const Limits& limits) noexcept {
  return limits.max_contacts >= 1 && limits.max_contacts <= 4096 && limits.cached_factors >= 1 &&
         limits.cached_factors <= 1024;
}

BodySizes measure_body(const ModelView& view, const Limits& limits) noexcept {
  BodySizes sizes;
  if (!in_range(limits) || view.node_count > most_nodes) {
    return sizes;
  }
  sizes.counts.nodes = view.node_count;
  sizes.counts.levels = view.levels;
  sizes.counts.max_contacts = limits.max_contacts;
  sizes.counts.cached_factors = limits.cached_factors;
  std::uint32_t most_neighbours[layout::max_levels] = {};
  std::uint64_t predicted = 0;
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    const LiftingCounts lifting = count_lifting(view, q);
    most_neighbours[q] = lifting.most_neighbours;
    sizes.lifting_records[q] = lifting.records;
    predicted += view.level[q].counts->domain_count;
  }
  std::uint64_t lifted = 0;
  for (std::uint32_t r = 0; r < view.levels; ++r) {
    lifted += sizes.lifting_records[r];
    sizes.counts.transform_work[r] = inverse_transform_work(lifted, predicted);
  }
  for (std::uint32_t c = 0; c < view.levels; ++c) {
    const std::uint32_t columns = view.level[c].counts->column_count;
    sizes.level_columns = larger(sizes.level_columns, columns);
    sizes.functional_bound[c] = bound_functionals(view, c, most_neighbours);
    sizes.longest_functional = larger(sizes.longest_functional, sizes.functional_bound[c]);
    if (columns > 0 && sizes.functional_bound[c] == 0) {
      return sizes;
    }
  }
  sizes.set_columns = sizes.level_columns < limits.max_contacts ? sizes.level_columns : limits.max_contacts;
  sizes.supported = true;
  return sizes;
}

Requirement bound_work(const ModelView& view, const BodySizes& sizes) noexcept {
  Requirement requirement;
  std::uint64_t plans = check_contacts_work(sizes.counts.max_contacts);
  for (std::uint32_t c = view.levels; c-- > 0;) {
    if (view.level[c].counts->column_count == 0) {
      continue;
    }
    const SetCounts most = most_counts(view, c, sizes.counts.max_contacts, sizes.functional_bound[c]);
    plans += plan_work(sizes.counts, most.contacts, most.columns);
    const std::uint64_t forces = factor_work(sizes.counts, most) + force_work(most);
    requirement.worst_work[c] = plans + forces + field_work(sizes.counts, most, view.levels - 1);
    // the coarsest level comes last
    requirement.least_work = plans + forces + field_work(sizes.counts, most, 0);
  }
  return requirement;
}

}  // namespace greenloop
