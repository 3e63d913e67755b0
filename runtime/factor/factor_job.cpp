#include "runtime/factor/factor_job.hpp"

#include <cstring>

#include "runtime/algebra/cholesky.hpp"

namespace greenloop {

template <unsigned N>
void FactorScratch::carve(Arena& arena, std::uint32_t columns) noexcept {
  const std::uint64_t stride = padded_order(N * columns);
  order = arena.take<std::uint32_t>(columns);
  border = arena.take<Float4>(N * stride / 4);
}

namespace {

// begins the rows of the capacitance matrix of nodes that enter a factor: the last ones of `order`, which lists its
// nodes and then those
template <unsigned N>
PartialCapacitance begin_rows(const FactorTools<N>& tools, const Touched& touched, ColumnSet order,
                              std::uint32_t entering) {
  PartialCapacitance rows;
  rows.set = order;
  rows.computed = entering;
  rows.panel = has_panel(tools.capacitance.room, count_slots(order, touched), entering);
  begin_capacitance<N>(tools.refinement, touched, tools.capacitance, tools.force, rows);
  return rows;
}

// borders a factor by the t-th of them; false if it is not positive definite
template <unsigned N>
bool enter_node(const FactorTools<N>& tools, const PartialCapacitance& rows, std::uint32_t t, Factor& factor) {
  const std::uint32_t stride = tools.cache.stride();
  store_capacitance_row(tools.capacitance, rows, t, stride, tools.scratch.border);
  return append_node<N>(rows.set.column[factor.columns], stride, factor, tools.scratch.border);
}

// borders a factor by the nodes that enter; false if it is not positive definite
template <unsigned N>
bool enter_nodes(const FactorTools<N>& tools, const FactorChanges& changes, const Touched& touched, Factor& factor) {
  std::uint32_t* const order = tools.scratch.order;
  std::memcpy(order, factor.node, sizeof(std::uint32_t) * factor.columns);
  std::memcpy(order + factor.columns, changes.in, sizeof(std::uint32_t) * changes.added);
  PartialCapacitance rows = begin_rows(tools, touched, {factor.columns + changes.added, order}, changes.added);
  tools.scratch.spent += add_capacitance_blocks(tools.refinement, touched, tools.capacitance, ~std::uint64_t{0}, rows);
  bool definite = true;
  for (std::uint32_t t = 0; definite && t < changes.added; ++t) {
    tools.scratch.spent += cholesky_append_work(tools.counts.prices, N * factor.columns, N);
    definite = enter_node(tools, rows, t, factor);
  }
  release_capacitance(rows, tools.capacitance);
  return definite;
}

// takes the nodes that leave out of a copy of the base; the units that that took, besides the copy
template <unsigned N>
std::uint64_t copy_without(const FactorChanges& changes, const FactorTools<N>& tools, Factor& factor) {
  const std::uint32_t stride = tools.cache.stride();
  if (changes.base != &factor) {
    copy_factor<N>(*changes.base, stride, factor);
  }
  std::uint64_t work = 0;
  for (std::uint32_t t = 0; t < changes.removed; ++t) {
    const std::uint32_t columns = factor.columns;
    const std::uint32_t place = remove_node<N>(changes.out[t], stride, factor, tools.scratch.border);
    work += cholesky_remove_work(tools.counts.prices, N * columns, N * place, N);
  }
  return work;
}

// apart, so that neither has the stack of the other
template <unsigned N>
[[gnu::noinline]] Factor* make_fresh(const FactorTools<N>& tools, ColumnSet set, const Touched& touched) {
  Factor& factor = tools.cache.make_room(set);
  tools.scratch.spent += assemble_capacitance<N>(tools.refinement, set, touched, tools.capacitance, tools.force,
                                                 tools.cache.stride(), factor.matrix);
  keep_capacitance<N>(set.count, tools.cache.stride(), factor);
  factor.changes = 0;
  for (std::uint32_t k = 0; k < set.count; ++k) {
    factor.node[k] = set.column[k];
    factor.position[k] = k;
  }
  return tools.cholesky_factor(N * set.count, tools.cache.stride(), factor.matrix) ? &factor : nullptr;
}

template <unsigned N>
[[gnu::noinline]] Factor* make_from(const FactorTools<N>& tools, ColumnSet set, const Touched& touched,
                                    const FactorChanges& changes) {
  const std::uint32_t changed = changes.base->changes + changes.added + changes.removed;
  Factor& factor = tools.cache.make_room(set);
  tools.scratch.spent += copy_without(changes, tools, factor);
  factor.changes = changed;
  if (changes.added > 0 && !enter_nodes(tools, changes, touched, factor)) {
    return nullptr;
  }
  list_positions(set, tools.index_of_place, factor);
  return &factor;
}

}  // namespace

template <unsigned N>
Factor* make_factor(const FactorTools<N>& tools, ColumnSet set, const Touched& touched,
                    const FactorChanges* changes) noexcept {
  return changes == nullptr ? make_fresh(tools, set, touched) : make_from(tools, set, touched, *changes);
}

namespace {

// nodes of a factor that stay, less those that have to leave; 0: rather begin anew
std::uint32_t worth(Factor& factor, ColumnSet set, FactorChanges& changes) {
  if (!may_share_columns(factor, set)) {
    return 0;
  }
  list_changes(factor, set, changes);
  const std::uint32_t stay = changes.base == nullptr ? 0 : factor.columns - changes.removed;
  return stay > changes.removed ? stay - changes.removed : 0;
}

// the set after the batch, without a matrix
Factor after_batch(const FactorJob& job) {
  Factor after;
  after.column = job.column;
  after.columns = job.columns;
  return after;
}

// whether the batch that is at work serves the set
bool serves(FactorJob& job, ColumnSet set) {
  Factor after = after_batch(job);
  return worth(after, set, job.changes) > 0;
}

// whether the set has all the nodes that turned out not to be positive definite
bool is_singular(FactorJob& job, ColumnSet set) {
  if (!job.singular) {
    return false;
  }
  Factor after = after_batch(job);
  list_changes(after, set, job.changes);
  return job.changes.base != nullptr && job.changes.removed == 0;
}

bool may_change(const Factor& factor) { return factor.changes < FactorChanges::most_in_a_row; }

// the factor in the making, or the cached one that has most in common with the set, or nothing in the former's place
Factor* choose_base(FactorJob& job, const FactorCache& cache, ColumnSet set) {
  Factor& own = job.factor;
  if (may_change(own) && worth(own, set, job.changes) > 0) {
    return &own;
  }
  Factor* best = nullptr;
  std::uint32_t most = 0;
  for (std::uint32_t i = 0; i < cache.size(); ++i) {
    Factor& factor = cache[i];
    const std::uint32_t common = factor.key != 0 && may_change(factor) ? worth(factor, set, job.changes) : 0;
    if (common > most) {
      best = &factor;
      most = common;
    }
  }
  if (best == nullptr) {
    own.columns = 0;
    own.changes = 0;
    best = &own;
  }
  return best;
}

void take_out(std::uint32_t node, std::uint32_t columns, Factor& factor) {
  std::uint32_t at = 0;
  while (factor.column[at] != node) {
    ++at;
  }
  std::memmove(factor.column + at, factor.column + at + 1, sizeof(std::uint32_t) * (columns - at - 1));
}

void put_in(std::uint32_t node, Factor& factor) {
  std::uint32_t at = factor.columns;
  for (; at > 0 && factor.column[at - 1] > node; --at) {
    factor.column[at] = factor.column[at - 1];
  }
  factor.column[at] = node;
}

// the factor without the nodes that leave; the units that these took
template <unsigned N>
std::uint64_t begin_from(FactorJob& job, const FactorTools<N>& tools) {
  const FactorChanges& changes = job.changes;
  std::uint32_t columns = changes.base->columns;
  if (changes.base != &job.factor) {
    std::memcpy(job.factor.column, changes.base->column, sizeof(std::uint32_t) * columns);
  }
  for (std::uint32_t t = 0; t < changes.removed; ++t) {
    take_out(changes.out[t], columns--, job.factor);
  }
  job.factor.changes += changes.removed;
  return copy_without(changes, tools, job.factor);
}

// nodes of the set that the factor lacks, `most` of them at most, in `missing`; those and the factor's in `together`
std::uint32_t list_batch(const Factor& factor, ColumnSet set, std::uint32_t most, std::uint32_t* missing,
                         std::uint32_t* together) {
  std::uint32_t added = 0;
  std::uint32_t i = 0;
  for (std::uint32_t k = 0; k < set.count; ++k) {
    const std::uint32_t column = set.column[k];
    if (i < factor.columns && factor.column[i] == column) {
      together[added + i++] = column;
    } else if (added < most) {
      together[added + i] = column;
      missing[added++] = column;
    }
  }
  return added;
}

// prepares for the nodes that enter; the units that that took
template <unsigned N>
std::uint64_t begin_batch(FactorJob& job, const FactorTools<N>& tools, ColumnSet set, std::uint32_t width) {
  const Factor& factor = job.factor;
  std::uint32_t* const order = tools.scratch.order;
  std::memcpy(order, factor.node, sizeof(std::uint32_t) * factor.columns);
  const std::uint32_t added = list_batch(factor, set, width, order + factor.columns, job.column);
  job.columns = factor.columns + added;
  job.entered = 0;
  touch(tools.refinement, job.column, job.columns, job.touched);
  job.counts = {};
  job.counts.columns = job.columns;
  count_factor({job.columns, job.column}, job.touched, tools.cost, tools.stored, job.counts);
  ChangeCounts changes{.added = added};
  for (std::uint32_t k = factor.columns; k < job.columns; ++k) {
    changes.entering.add(tools.cost, order[k], job.touched);
  }
  job.batch = begin_rows(tools, job.touched, {job.columns, order}, added);
  return begin_rows_work(tools.counts, job.counts, changes);
}

// borders the factor by the next node of the batch; without columns if it is not positive definite
template <unsigned N>
void enter_next(FactorJob& job, const FactorTools<N>& tools) {
  put_in(job.batch.set.column[job.factor.columns], job.factor);
  if (!enter_node(tools, job.batch, job.entered++, job.factor)) {
    job.factor.columns = 0;
    job.singular = true;
  }
}

// adds to `total`; false if the allowance does not hold what is next, or the factor failed
template <unsigned N>
bool continue_batch(FactorJob& job, const FactorTools<N>& tools, std::uint64_t allowance, std::uint64_t& total) {
  std::uint64_t work = add_capacitance_blocks(tools.refinement, job.touched, tools.capacitance, allowance, job.batch);
  bool holds = !job.batch.has_blocks_left();
  while (holds && job.entered < job.batch.computed) {
    const std::uint64_t node = enter_work(tools.counts, job.counts, job.factor.columns);
    holds = node <= allowance - work;
    if (holds) {
      enter_next(job, tools);
      work += node;
      holds = !job.singular;
    }
  }
  job.spent += work;
  total += work;
  if (job.singular || job.entered == job.batch.computed) {
    drop_batch(job, tools.capacitance);
  }
  return holds;
}

// the batch that is at work, or what begins the next; false if the allowance does not hold what is next, or the factor
// failed
template <unsigned N>
bool continue_changes(FactorJob& job, const FactorTools<N>& tools, ColumnSet set, const SetCounts& whole,
                      const Slice& slice, std::uint64_t& work) {
  const std::uint64_t allowance = slice.allowance;
  if (job.batch.computed > 0) {
    return continue_batch(job, tools, allowance - work, work);
  }
  const std::uint64_t begin = begin_batch_work(tools.counts, whole, job.changes.removed);
  if (begin > allowance - work) {
    return false;
  }
  const std::uint64_t most_for_rows = most_begin_rows_work(tools.counts, whole);
  work += begin - most_for_rows - leave_work(tools.counts, whole.columns, job.changes.removed) + begin_from(job, tools);
  if (job.changes.missing > 0) {
    job.spent = begin;
    const std::uint64_t width = slice.moving ? most_in_a_slice(tools.counts, whole, allowance - work - most_for_rows)
                                             : most_in_a_batch(tools.counts, whole);
    work += begin_batch(job, tools, set, static_cast<std::uint32_t>(width));
  }
  return true;
}

// bound of the work until the factor is that of the set
std::uint64_t left_of(FactorJob& job, const FactorCounts& counts, const SetCounts& whole) {
  if (job.changes.missing + job.changes.removed == 0) {
    return 0;
  }
  job.changes.missing += job.batch.computed > 0 ? job.entered : 0;
  const std::uint64_t left = pending_work(counts, whole, job.changes);
  return left > job.spent ? left - job.spent : left;
}

template <unsigned N>
void hand_over(FactorJob& job, const FactorTools<N>& tools, ColumnSet set) {
  list_positions(set, tools.index_of_place, job.factor);
  Factor& place = tools.cache.make_room(set);
  const Factor evicted = place;
  place = job.factor;
  job.factor = evicted;
  job.factor.columns = 0;
  tools.cache.keep(place, set);
}

}  // namespace

template <unsigned N>
void FactorJob::carve(Arena& arena, const ModelView& view, std::uint32_t columns_of_a_set,
                      bool keeps_capacitance) noexcept {
  factor.carve<N>(arena, columns_of_a_set, keeps_capacitance);
  column = arena.take<std::uint32_t>(columns_of_a_set);
  touched.carve(arena, view);
}

template <unsigned N>
FactorProgress continue_factor(FactorJob& job, const FactorTools<N>& tools, ColumnSet set, const SetCounts& whole,
                               const Slice& slice) noexcept {
  FactorProgress progress;
  progress.pending = pending_work(tools.counts, whole);
  const std::uint64_t compare =
      compare_factors_work(tools.counts, whole.columns) + drop_batch_work(tools.counts.prices, job);
  if (compare > slice.allowance) {
    return progress;
  }
  progress.work = compare;
  if (job.batch.computed > 0 && !serves(job, set)) {
    drop_batch(job, tools.capacitance);
  }
  job.singular = is_singular(job, set);
  if (job.singular) {
    progress.pending = 0;
    return progress;
  }
  const FactorChanges& changes = job.changes;
  const bool at_work = job.batch.computed > 0;
  list_changes(at_work ? job.factor : *choose_base(job, tools.cache, set), set, job.changes);
  for (bool holds = true; holds && changes.missing + changes.removed > 0;) {
    holds = continue_changes(job, tools, set, whole, slice, progress.work);
    list_changes(job.factor, set, job.changes);
    const bool part = !job.singular && job.batch.computed == 0 && changes.missing > 0;
    if (slice.keeps_parts && part && compare <= slice.allowance - progress.work) {
      progress.work += compare;
      hand_over(job, tools, {job.factor.columns, job.factor.column});
      list_changes(*choose_base(job, tools.cache, set), set, job.changes);
    }
  }
  progress.pending = job.singular ? 0 : left_of(job, tools.counts, whole);
  if (progress.pending == 0 && !job.singular) {
    drop_batch(job, tools.capacitance);
    hand_over(job, tools, set);
  }
  return progress;
}

std::uint64_t drop_batch_work(const Prices& prices, const FactorJob& job) noexcept {
  return job.batch.computed > 0 ? priced(job.counts.coefficients, prices.dropped) : 0;
}

template <unsigned N>
void drop_batch(FactorJob& job, CapacitanceScratch<N>& capacitance) noexcept {
  if (job.batch.computed > 0) {
    release_capacitance(job.batch, capacitance);
    clear(job.touched);
    job.batch.computed = 0;
    job.spent = 0;
  }
}

template void FactorScratch::carve<1>(Arena&, std::uint32_t) noexcept;
template void FactorJob::carve<1>(Arena&, const ModelView&, std::uint32_t, bool) noexcept;
template Factor* make_factor<1>(const FactorTools<1>&, ColumnSet, const Touched&, const FactorChanges*) noexcept;
template FactorProgress continue_factor<1>(FactorJob&, const FactorTools<1>&, ColumnSet, const SetCounts&,
                                           const Slice&) noexcept;
template void drop_batch<1>(FactorJob&, CapacitanceScratch<1>&) noexcept;
template void FactorScratch::carve<3>(Arena&, std::uint32_t) noexcept;
template void FactorJob::carve<3>(Arena&, const ModelView&, std::uint32_t, bool) noexcept;
template Factor* make_factor<3>(const FactorTools<3>&, ColumnSet, const Touched&, const FactorChanges*) noexcept;
template FactorProgress continue_factor<3>(FactorJob&, const FactorTools<3>&, ColumnSet, const SetCounts&,
                                           const Slice&) noexcept;
template void drop_batch<3>(FactorJob&, CapacitanceScratch<3>&) noexcept;

}  // namespace greenloop
