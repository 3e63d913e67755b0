#include "runtime/factor/factor_update.hpp"

#include <cstddef>
#include <cstring>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/wavelet/column.hpp"

namespace greenloop {
namespace {

std::uint32_t distance(std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; }

}  // namespace

void FactorUpdateScratch::carve(Arena& arena, std::uint32_t columns) noexcept {
  const std::uint64_t stride = padded_order(3 * columns);
  order = arena.take<std::uint32_t>(columns);
  border = arena.take<Float4>(3 * stride / 4);
}

bool may_share_columns(const Factor& factor, const ContactSet& set) noexcept {
  return factor.columns > 0 && set.columns > 0 && factor.column[0] <= set.column[set.columns - 1] &&
         set.column[0] <= factor.column[factor.columns - 1];
}

void list_changes(Factor& factor, const ContactSet& set, FactorChanges& changes) noexcept {
  changes.base = nullptr;
  changes.added = changes.removed = changes.missing = 0;
  std::uint32_t i = 0;
  std::uint32_t k = 0;
  while (i < factor.columns || k < set.columns) {
    const bool leaves = k == set.columns || (i < factor.columns && factor.column[i] < set.column[k]);
    const bool enters = i == factor.columns || (k < set.columns && set.column[k] < factor.column[i]);
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

void find_changes(const FactorCache& cache, const ContactSet& set, FactorChanges& nearest) noexcept {
  nearest.base = nullptr;
  FactorChanges changes;
  for (std::uint32_t i = 0; i < cache.size(); ++i) {
    Factor& factor = cache[i];
    if (factor.key == 0 || factor.changes >= FactorChanges::most_in_a_row ||
        distance(factor.columns, set.columns) > FactorChanges::most || !may_share_columns(factor, set)) {
      continue;
    }
    list_changes(factor, set, changes);
    if (changes.base != nullptr && changes.missing == changes.added &&
        (nearest.base == nullptr || changes.added + changes.removed < nearest.added + nearest.removed)) {
      nearest = changes;
    }
  }
}

ChangeCounts count_changes(const FactorChanges& changes, const ColumnCosts& cost) noexcept {
  ChangeCounts counts;
  counts.added = changes.added;
  counts.removed = changes.removed;
  for (std::uint32_t t = 0; t < changes.added; ++t) {
    counts.entering.add(cost.of(changes.in[t]));
  }
  return counts;
}

std::uint64_t update_factor_work(const ModelCounts& model, const SetCounts& set, const ChangeCounts& changes) noexcept {
  const auto order = static_cast<std::uint32_t>(3 * (set.columns + changes.removed));
  CapacitanceCounts capacitance = capacitance_counts(model, set);
  capacitance.rows = changes.added;
  capacitance.visits = changes.entering.visits;
  capacitance.coefficients = changes.entering.coefficients;
  capacitance.blocks = changes.entering.blocks;
  return std::uint64_t{order} * order / 2 + changes.removed * (set.columns + cholesky_remove_work(order, 0, 3)) +
         changes.added * cholesky_append_work(order, 3) + assemble_capacitance_work(capacitance) + 6 * set.columns;
}

void copy_factor(const Factor& from, std::uint32_t stride, Factor& to) noexcept {
  const std::uint32_t order = padded_order(3 * from.columns);
  for (std::uint32_t j = 0; j < order; ++j) {
    const std::size_t begin = std::size_t{j} * stride / 4 + j / 4;
    std::memcpy(to.matrix + begin, from.matrix + begin, sizeof(Float4) * (order / 4 - j / 4));
  }
  std::memcpy(to.node, from.node, sizeof(std::uint32_t) * from.columns);
  to.columns = from.columns;
  to.changes = from.changes;
}

void remove_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept {
  std::uint32_t at = 0;
  while (factor.node[at] != node) {
    ++at;
  }
  cholesky_remove(3 * factor.columns, 3 * at, 3, stride, factor.matrix, border);
  --factor.columns;
  std::memmove(factor.node + at, factor.node + at + 1, sizeof(std::uint32_t) * (factor.columns - at));
}

bool append_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept {
  if (!cholesky_append(3 * factor.columns, 3, stride, factor.matrix, border)) {
    return false;
  }
  factor.node[factor.columns++] = node;
  return true;
}

void list_positions(const ContactSet& set, Factor& factor) noexcept {
  for (std::uint32_t i = 0; i < factor.columns; ++i) {
    set.index_of_place[column_place(factor.node[i])] = i;
  }
  for (std::uint32_t k = 0; k < set.columns; ++k) {
    std::uint32_t& index = set.index_of_place[column_place(set.column[k])];
    factor.position[k] = index;
    index = layout::none;
  }
}

namespace {

// borders a factor by the nodes that enter; false if it is not positive definite
bool enter_nodes(const ContactSet& set, const FactorChanges& changes, const CapacitanceSource& source,
                 std::uint32_t stride, Factor& factor, FactorUpdateScratch& scratch) {
  const std::uint32_t kept = factor.columns;
  std::memcpy(scratch.order, factor.node, sizeof(std::uint32_t) * kept);
  std::memcpy(scratch.order + kept, changes.in, sizeof(std::uint32_t) * changes.added);
  PartialCapacitance rows;
  rows.set = {set.columns, scratch.order};
  rows.computed = changes.added;
  rows.panel = has_panel(source.scratch.room, count_slots(rows.set, source.touched), changes.added);
  begin_capacitance(source.refinement, source.touched, source.scratch, source.force, rows);
  add_capacitance_blocks(source.refinement, source.touched, source.scratch, ~std::uint64_t{0}, rows);
  bool definite = true;
  for (std::uint32_t t = 0; definite && t < changes.added; ++t) {
    store_capacitance_row(source.scratch, rows, t, stride, scratch.border);
    definite = append_node(changes.in[t], stride, factor, scratch.border);
  }
  release_capacitance(rows, source.scratch);
  return definite;
}

}  // namespace

Factor* update_factor(FactorCache& cache, const ContactSet& set, const FactorChanges& changes,
                      const CapacitanceSource& source, FactorUpdateScratch& scratch) noexcept {
  const std::uint32_t stride = cache.stride();
  const std::uint32_t changed = changes.base->changes + changes.added + changes.removed;
  Factor& factor = cache.make_room(set);
  if (&factor != changes.base) {
    copy_factor(*changes.base, stride, factor);
  }
  factor.changes = changed;
  for (std::uint32_t t = 0; t < changes.removed; ++t) {
    remove_node(changes.out[t], stride, factor, scratch.border);
  }
  if (changes.added > 0 && !enter_nodes(set, changes, source, stride, factor, scratch)) {
    return nullptr;
  }
  list_positions(set, factor);
  return &factor;
}

}  // namespace greenloop
