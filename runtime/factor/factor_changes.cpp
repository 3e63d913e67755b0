#include "runtime/factor/factor_changes.hpp"

namespace greenloop {
namespace {

std::uint32_t distance(std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; }

}  // namespace

bool may_share_columns(const Factor& factor, ColumnSet set) noexcept {
  return factor.columns > 0 && set.count > 0 && factor.column[0] <= set.column[set.count - 1] &&
         set.column[0] <= factor.column[factor.columns - 1];
}

void list_changes(Factor& factor, ColumnSet set, FactorChanges& changes) noexcept {
  changes.base = nullptr;
  changes.added = changes.removed = changes.missing = 0;
  std::uint32_t i = 0;
  std::uint32_t k = 0;
  while (i < factor.columns || k < set.count) {
    const bool leaves = k == set.count || (i < factor.columns && factor.column[i] < set.column[k]);
    const bool enters = i == factor.columns || (k < set.count && set.column[k] < factor.column[i]);
    if (leaves && changes.removed == FactorChanges::most) {
      return;
    }
    if (leaves) {
      changes.out[changes.removed++] = factor.column[i++];
    } else if (enters) {
      if (changes.added < FactorChanges::most) {
        changes.in[changes.added++] = set.column[k];
      }
      ++changes.missing;
      ++k;
    } else {
      ++i;
      ++k;
    }
  }
  changes.base = &factor;
}

void find_changes(const FactorCache& cache, ColumnSet set, FactorChanges& nearest) noexcept {
  nearest.base = nullptr;
  FactorChanges changes;
  for (std::uint32_t i = 0; i < cache.size(); ++i) {
    Factor& factor = cache[i];
    if (factor.key == 0 || factor.changes >= FactorChanges::most_in_a_row ||
        distance(factor.columns, set.count) > FactorChanges::most || !may_share_columns(factor, set)) {
      continue;
    }
    list_changes(factor, set, changes);
    if (changes.base != nullptr && changes.missing == changes.added &&
        (nearest.base == nullptr || changes.added < nearest.added ||
         (changes.added == nearest.added && changes.removed < nearest.removed))) {
      nearest = changes;
    }
  }
}

ChangeCounts count_changes(const FactorChanges& changes, const ColumnCosts& cost, const Touched& touched) noexcept {
  ChangeCounts counts;
  counts.added = changes.added;
  counts.removed = changes.removed;
  for (std::uint32_t t = 0; t < changes.added; ++t) {
    counts.entering.add(cost, changes.in[t], touched);
  }
  return counts;
}

}  // namespace greenloop
