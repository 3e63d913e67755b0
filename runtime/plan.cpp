#include "runtime/plan.hpp"

#include "runtime/block_columns.hpp"
#include "runtime/capacitance.hpp"
#include "runtime/factor_cache.hpp"
#include "runtime/lu.hpp"

namespace greenloop {
namespace {

// columns that hold at least `least` blocks, and the blocks in those that hold more
struct Tally {
  std::uint64_t columns = 0;
  std::uint64_t blocks_above = 0;
  std::uint64_t columns_above = 0;
};

Tally tally(const ModelView& view, std::uint32_t constraint_level, std::uint32_t row_level, std::uint32_t least) {
  Tally result;
  for (std::uint32_t j = 0; j < view.level[constraint_level].counts->column_count; ++j) {
    const std::uint32_t blocks = column_blocks(view, constraint_level, j, row_level);
    result.columns += blocks >= least ? 1 : 0;
    result.columns_above += blocks > least ? 1 : 0;
    result.blocks_above += blocks > least ? blocks : 0;
  }
  return result;
}

// blocks in the `count` columns that hold most
std::uint64_t most_blocks(const ModelView& view, std::uint32_t constraint_level, std::uint32_t row_level,
                          std::uint64_t count) {
  // bisect for the number of blocks in the last of them
  std::uint32_t low = 0;
  std::uint32_t high = domain_up_to(view, row_level) + 1;
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    (tally(view, constraint_level, row_level, middle).columns >= count ? low : high) = middle;
  }
  const Tally above = tally(view, constraint_level, row_level, low);
  return above.blocks_above + (count - above.columns_above) * low;
}

}  // namespace

std::uint64_t plan_work(const ModelCounts& model, std::uint64_t contacts, std::uint64_t columns) noexcept {
  return resolve_contacts_work(contacts) + columns * (model.levels + 1) + std::uint64_t{2} * model.levels +
         FactorCache::find_work(model.cached_factors, columns);
}

std::uint64_t factor_work(const ModelCounts& model, const SetCounts& set) noexcept {
  const auto order = static_cast<std::uint32_t>(3 * set.columns);
  return FactorCache::find_work(model.cached_factors, set.columns) +
         assemble_capacitance_work(set.columns, set.coefficients, set.blocks[model.levels - 1]) + lu_factor_work(order);
}

std::uint64_t force_work(const SetCounts& set) noexcept {
  return merge_work(set.contacts, set.columns) + lu_solve_work(static_cast<std::uint32_t>(3 * set.columns));
}

std::uint64_t field_work(const ModelCounts& model, const SetCounts& set, std::uint32_t field_level) noexcept {
  return model.nodes + 9 * set.blocks[field_level] + model.transform_work[field_level];
}

SetCounts count_set(const ModelView& view, const ContactSet& set, std::uint64_t contacts,
                    const std::uint32_t* functional_size) noexcept {
  SetCounts counts;
  counts.contacts = contacts;
  counts.columns = set.columns;
  for (std::uint32_t k = 0; k < set.columns; ++k) {
    counts.coefficients += functional_size[set.column[k]];
  }
  std::uint64_t blocks = 0;
  for (std::uint32_t r = 0; r < view.levels; ++r) {
    const std::uint32_t* begin = view.blocks[set.level][r].begin;
    for (std::uint32_t k = 0; k < set.columns; ++k) {
      blocks += begin[set.column[k] + 1] - begin[set.column[k]];
    }
    counts.blocks[r] = blocks;
  }
  return counts;
}

SetCounts most_counts(const ModelView& view, std::uint32_t constraint_level, std::uint32_t max_contacts,
                      std::uint32_t functional_bound) noexcept {
  const std::uint32_t columns = view.level[constraint_level].counts->column_count;
  SetCounts counts;
  counts.contacts = max_contacts;
  counts.columns = columns < max_contacts ? columns : max_contacts;
  counts.coefficients = counts.columns * functional_bound;
  for (std::uint32_t r = 0; r < view.levels; ++r) {
    counts.blocks[r] = most_blocks(view, constraint_level, r, counts.columns);
  }
  return counts;
}

}  // namespace greenloop
