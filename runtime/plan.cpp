#include "runtime/plan.hpp"

#include "runtime/cholesky.hpp"
#include "runtime/domain.hpp"
#include "runtime/factor_cache.hpp"
#include "runtime/field.hpp"

namespace greenloop {
namespace {

std::uint64_t smaller(std::uint64_t a, std::uint64_t b) { return a < b ? a : b; }

// counts by level of the rows become counts of the rows of levels 0..F
void accumulate(std::uint32_t levels, std::uint64_t* blocks) {
  for (std::uint32_t level = 1; level < levels; ++level) {
    blocks[level] += blocks[level - 1];
  }
}

// most coefficients of a group that forces on `nodes` nodes of K(c) touch
std::uint64_t most_touched(const Coefficients& coefficients, const ReachBound& reach, std::uint32_t group,
                           std::uint32_t c, std::uint64_t nodes) {
  const CoefficientGroup& of = coefficients.group[group];
  if (of.level > c) {
    return 0;
  }
  const bool averages = group == 0 || !Coefficients::has_diagonal(group);
  return smaller(of.count, nodes * (averages ? reach.averages[of.level] : reach.details[of.level]));
}

}  // namespace

std::uint64_t plan_work(const ModelCounts& model, const SetCounts& set) noexcept {
  return resolve_contacts_work(set.contacts) + 4 * set.columns + 2 * set.visits + 16 * set.coefficients +
         2 * model.sections + FactorCache::find_work(model.cached_factors, set.columns);
}

std::uint64_t factor_work(const ModelCounts& model, const SetCounts& set) noexcept {
  const auto order = static_cast<std::uint32_t>(3 * set.columns);
  return FactorCache::find_work(model.cached_factors, set.columns) +
         assemble_capacitance_work(set.columns, set.coefficients, set.stored, set.column_visits,
                                   set.column_coefficients, set.column_blocks) +
         cholesky_factor_work(order);
}

std::uint64_t force_work(const SetCounts& set) noexcept {
  return merge_work(set.contacts, set.columns) + cholesky_solve_work(static_cast<std::uint32_t>(3 * set.columns));
}

std::uint64_t field_work(const ModelCounts& model, const SetCounts& set, std::uint32_t field_level) noexcept {
  return 3 * set.visits + 24 * set.coefficients + 9 * set.blocks[field_level] + 9 * model.rows[field_level] +
         model.nodes + model.transform_work[field_level] + 4 * set.contacts + 2 * model.sections;
}

SetCounts count_set(const ModelView& view, const Coefficients& coefficients, const Couplings& couplings,
                    const ContactSet& set, const Touched& touched, std::uint64_t contacts,
                    const ColumnCost* cost) noexcept {
  SetCounts counts;
  counts.contacts = contacts;
  counts.columns = set.columns;
  counts.coefficients = touched.coefficients();
  counts.visits = touched.visits;
  for (std::uint32_t k = 0; k < set.columns; ++k) {
    counts.column_coefficients += cost[set.column[k]].coefficients;
    counts.column_blocks += cost[set.column[k]].blocks;
    counts.column_visits += cost[set.column[k]].visits;
  }
  for (std::uint32_t s = 0; s < couplings.count; ++s) {
    const CouplingSection& section = couplings.section[s];
    const std::uint32_t column_begin = coefficients.group[section.column_group].begin;
    std::uint64_t direct = 0;
    for (std::uint32_t k = 0; k < touched.count[section.column_group]; ++k) {
      direct += section.direct_length(touched.list[section.column_group][k] - column_begin);
    }
    counts.stored += direct;
    if (!in_field(view, section)) {
      continue;
    }
    counts.blocks[section.row_level] += direct;
    const std::uint32_t row_begin = coefficients.group[section.row_group].begin;
    for (std::uint32_t k = 0; k < touched.count[section.row_group]; ++k) {
      const std::uint32_t row = touched.list[section.row_group][k] - row_begin;
      counts.blocks[section.column_level] += section.mirrored_length(row);
    }
  }
  accumulate(view.levels, counts.blocks);
  return counts;
}

SetCounts most_counts(const ModelView& view, const Coefficients& coefficients,
                      const LongestLists (&longest)[Couplings::most], std::uint32_t c, std::uint32_t max_contacts,
                      const ReachBound& reach) noexcept {
  SetCounts counts;
  counts.contacts = max_contacts;
  counts.columns = smaller(domain_up_to(view, c), max_contacts);
  counts.visits = counts.columns * reach.visits;
  counts.column_visits = counts.visits;
  for (std::uint32_t g = 0; g < Coefficients::groups; ++g) {
    counts.coefficients += most_touched(coefficients, reach, g, c, counts.columns);
    counts.column_coefficients += counts.columns * most_touched(coefficients, reach, g, c, 1);
  }
  CouplingSection section;
  for (std::uint32_t s = 0; s < Couplings::most; ++s) {
    if (!find_section(view, s, section)) {
      continue;
    }
    const std::uint64_t all = section.view.begin[section.view.columns];
    const auto bound = [&](std::uint32_t group, std::uint32_t length, std::uint64_t nodes) {
      return smaller(all, length * most_touched(coefficients, reach, group, c, nodes));
    };
    if (in_field(view, section)) {
      counts.blocks[section.row_level] += bound(section.column_group, longest[s].direct, counts.columns);
      counts.blocks[section.column_level] += bound(section.row_group, longest[s].mirrored, counts.columns);
    }
    counts.stored += bound(section.column_group, longest[s].direct, counts.columns);
    if (section.column_level <= c) {
      counts.column_blocks += counts.columns * (bound(section.column_group, longest[s].direct, 1) +
                                                bound(section.row_group, longest[s].mirrored, 1));
    }
  }
  accumulate(view.levels, counts.blocks);
  return counts;
}

}  // namespace greenloop
