#include "runtime/factor/pending_factor.hpp"

#include <cstring>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/elastostatic/body.hpp"

namespace greenloop {
namespace {

// columns of a set that are summed together
std::uint64_t most_in_a_batch(const ModelCounts& model, const SetCounts& whole) {
  return batch_width(model.capacitance_room, whole.coefficients > 0 ? whole.coefficients : 1);
}

// bounds for any batch of a set
CapacitanceCounts batch_counts(const ModelCounts& model, const SetCounts& whole) {
  CapacitanceCounts counts = capacitance_counts(model, whole);
  counts.bounds = counts.bounds || !has_panel(counts.room, counts.slots, counts.rows);
  return counts;
}

// nodes of a factor that stay, less those that have to leave; 0: rather begin anew
std::uint32_t worth(Factor& factor, const ContactSet& set, FactorChanges& changes) {
  if (!may_share_columns(factor, set)) {
    return 0;
  }
  list_changes(factor, set, changes);
  const std::uint32_t stay = changes.base == nullptr ? 0 : factor.columns - changes.removed;
  return stay > changes.removed ? stay - changes.removed : 0;
}

// the set after the batch, without a matrix
Factor after_batch(const PendingFactor& pending) {
  Factor after;
  after.column = pending.column;
  after.columns = pending.columns;
  return after;
}

// whether the batch that is at work serves the set
bool serves(PendingFactor& pending, const ContactSet& set) {
  Factor after = after_batch(pending);
  return worth(after, set, pending.changes) > 0;
}

// whether the set has all the nodes that turned out not to be positive definite
bool is_singular(PendingFactor& pending, const ContactSet& set) {
  if (!pending.singular) {
    return false;
  }
  Factor after = after_batch(pending);
  list_changes(after, set, pending.changes);
  return pending.changes.base != nullptr && pending.changes.removed == 0;
}

bool may_change(const Factor& factor) { return factor.changes < FactorChanges::most_in_a_row; }

// the factor in the making, or the cached one that has most in common with the set, or nothing in the former's place
Factor* choose_base(Body& body) {
  const ContactSet& set = body.set;
  Factor& own = body.pending.factor;
  FactorChanges& changes = body.pending.changes;
  if (may_change(own) && worth(own, set, changes) > 0) {
    return &own;
  }
  Factor* best = nullptr;
  std::uint32_t most = 0;
  for (std::uint32_t i = 0; i < body.cache.size(); ++i) {
    Factor& factor = body.cache[i];
    const std::uint32_t common = factor.key != 0 && may_change(factor) ? worth(factor, set, changes) : 0;
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

void take_out(std::uint32_t node, Factor& factor) {
  std::uint32_t at = 0;
  while (factor.column[at] != node) {
    ++at;
  }
  std::memmove(factor.column + at, factor.column + at + 1, sizeof(std::uint32_t) * (factor.columns - at - 1));
}

void put_in(std::uint32_t node, Factor& factor) {
  std::uint32_t at = factor.columns;
  for (; at > 0 && factor.column[at - 1] > node; --at) {
    factor.column[at] = factor.column[at - 1];
  }
  factor.column[at] = node;
}

// the factor without the nodes that leave
void begin_from(Body& body) {
  Factor& factor = body.pending.factor;
  const FactorChanges& changes = body.pending.changes;
  const std::uint32_t stride = body.cache.stride();
  if (changes.base != &factor) {
    copy_factor(*changes.base, stride, factor);
    std::memcpy(factor.column, changes.base->column, sizeof(std::uint32_t) * factor.columns);
  }
  factor.changes += changes.removed;
  for (std::uint32_t t = 0; t < changes.removed; ++t) {
    take_out(changes.out[t], factor);
    remove_node(changes.out[t], stride, factor, body.update.border);
  }
}

// nodes of the set that the factor lacks, `most` of them at most, in `missing`; those and the factor's in `together`
std::uint32_t list_batch(const Factor& factor, const ContactSet& set, std::uint32_t most, std::uint32_t* missing,
                         std::uint32_t* together) {
  std::uint32_t added = 0;
  std::uint32_t i = 0;
  for (std::uint32_t k = 0; k < set.columns; ++k) {
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

// prepares for the nodes that enter
void begin_batch(Body& body, const SetCounts& whole) {
  PendingFactor& pending = body.pending;
  const Factor& factor = pending.factor;
  const auto width = static_cast<std::uint32_t>(most_in_a_batch(body.counts, whole));
  std::memcpy(body.update.order, factor.node, sizeof(std::uint32_t) * factor.columns);
  const std::uint32_t added = list_batch(factor, body.set, width, body.update.order + factor.columns, pending.column);
  pending.columns = factor.columns + added;
  pending.batch.set = {pending.columns, body.update.order};
  pending.batch.computed = added;
  pending.entered = 0;
  touch(body.refinement, pending.column, pending.columns, pending.touched);
  pending.batch.panel = has_panel(body.capacitance.room, count_slots(pending.batch.set, pending.touched), added);
  ContactSet after = body.set;
  after.column = pending.column;
  after.columns = pending.columns;
  pending.counts = {};
  pending.counts.columns = pending.columns;
  count_factor(after, pending.touched, body.cost, body.stored, pending.counts);
  begin_capacitance(body.refinement, pending.touched, body.capacitance, body.force, pending.batch);
}

// borders the factor by the next node of the batch; without columns if it is not positive definite
void enter(Body& body) {
  PendingFactor& pending = body.pending;
  Factor& factor = pending.factor;
  const PartialCapacitance& batch = pending.batch;
  const std::uint32_t stride = body.cache.stride();
  const std::uint32_t node = batch.set.column[factor.columns];
  store_capacitance_row(body.capacitance, batch, pending.entered++, stride, body.update.border);
  put_in(node, factor);
  if (!append_node(node, stride, factor, body.update.border)) {
    factor.columns = 0;
    pending.singular = true;
  }
}

// adds to `total`; false if the allowance does not hold what is next, or the factor failed
bool continue_batch(Body& body, std::uint64_t allowance, std::uint64_t& total) {
  PendingFactor& pending = body.pending;
  std::uint64_t work =
      add_capacitance_blocks(body.refinement, pending.touched, body.capacitance, allowance, pending.batch);
  bool holds = !pending.batch.has_blocks_left();
  while (holds && pending.entered < pending.batch.computed) {
    const std::uint64_t node = enter_work(pending.counts, pending.factor.columns);
    holds = node <= allowance - work;
    if (holds) {
      enter(body);
      work += node;
      holds = !pending.singular;
    }
  }
  pending.spent += work;
  total += work;
  if (pending.singular || pending.entered == pending.batch.computed) {
    drop_batch(body);
  }
  return holds;
}

// the batch that is at work, or what begins the next; false if the allowance does not hold what is next, or the factor
// failed
bool continue_changes(Body& body, const SetCounts& whole, std::uint64_t allowance, std::uint64_t& work) {
  PendingFactor& pending = body.pending;
  if (pending.batch.computed > 0) {
    return continue_batch(body, allowance - work, work);
  }
  const std::uint64_t begin = begin_batch_work(body.counts, whole, pending.changes.removed);
  if (begin > allowance - work) {
    return false;
  }
  work += begin;
  begin_from(body);
  if (pending.changes.missing > 0) {
    pending.spent = begin;
    begin_batch(body, whole);
  }
  return true;
}

// bound of the work until the factor is that of the set
std::uint64_t left_of(Body& body, const SetCounts& whole) {
  PendingFactor& pending = body.pending;
  if (pending.changes.missing + pending.changes.removed == 0) {
    return 0;
  }
  pending.changes.missing += pending.batch.computed > 0 ? pending.entered : 0;
  const std::uint64_t left = pending_work(body.counts, whole, pending.changes);
  return left > pending.spent ? left - pending.spent : left;
}

void hand_over(Body& body) {
  PendingFactor& pending = body.pending;
  list_positions(body.set, pending.factor);
  Factor& place = body.cache.make_room(body.set);
  const Factor evicted = place;
  place = pending.factor;
  pending.factor = evicted;
  pending.factor.columns = 0;
  body.cache.keep(place, body.set);
}

}  // namespace

void PendingFactor::carve(Arena& arena, const ModelView& view, std::uint32_t columns_of_a_set) noexcept {
  factor.carve(arena, columns_of_a_set);
  column = arena.take<std::uint32_t>(columns_of_a_set);
  touched.carve(arena, view);
}

std::uint64_t compare_factors_work(std::uint64_t factors, std::uint64_t columns) noexcept {
  return find_changes_work(factors + 4, columns);
}

std::uint64_t begin_batch_work(const ModelCounts& model, const SetCounts& set, std::uint64_t removed) noexcept {
  const std::uint64_t columns = set.columns + removed;
  const auto order = static_cast<std::uint32_t>(3 * columns);
  return std::uint64_t{order} * order / 2 + removed * (2 * columns + cholesky_remove_work(order, 0, 3)) + 12 * columns +
         touch_work(set) + begin_capacitance_work(batch_counts(model, set));
}

std::uint64_t enter_work(const SetCounts& set, std::uint64_t columns_before) noexcept {
  return store_capacitance_work(set.columns) + columns_before +
         cholesky_append_work(static_cast<std::uint32_t>(3 * columns_before), 3);
}

std::uint64_t most_slice_work(const ModelCounts& model, const SetCounts& whole) noexcept {
  const std::uint64_t fresh = factor_work(model, whole);
  const std::uint64_t begin = begin_batch_work(model, whole, FactorChanges::most);
  return compare_factors_work(model.cached_factors, whole.columns) + (fresh > begin ? fresh : begin);
}

std::uint64_t pending_work(const ModelCounts& model, const SetCounts& whole, const FactorChanges& changes) noexcept {
  const std::uint64_t missing = changes.missing;
  const std::uint64_t most = most_in_a_batch(model, whole);
  const std::uint64_t adding = (missing + most - 1) / most;
  const std::uint64_t batches = adding == 0 && changes.removed > 0 ? 1 : adding;
  CapacitanceCounts counts = batch_counts(model, whole);
  const std::uint64_t once = add_capacitance_blocks_work(counts);
  counts.blocks = counts.rows = 0;  // each row is in one batch
  const std::uint64_t blocks = adding > 0 ? once + (adding - 1) * add_capacitance_blocks_work(counts) : 0;
  return batches * begin_batch_work(model, whole, changes.removed) + blocks +
         missing * enter_work(whole, whole.columns);
}

std::uint64_t pending_work(const ModelCounts& model, const SetCounts& whole) noexcept {
  FactorChanges changes;
  changes.missing = static_cast<std::uint32_t>(whole.columns);
  return pending_work(model, whole, changes);
}

PendingProgress continue_factor(Body& body, const SetCounts& whole, std::uint64_t allowance) noexcept {
  PendingFactor& pending = body.pending;
  PendingProgress progress;
  progress.pending = pending_work(body.counts, whole);
  const std::uint64_t compare =
      compare_factors_work(body.counts.cached_factors, whole.columns) + drop_batch_work(pending);
  if (compare > allowance) {
    return progress;
  }
  progress.work = compare;
  if (pending.batch.computed > 0 && !serves(pending, body.set)) {
    drop_batch(body);
  }
  pending.singular = is_singular(pending, body.set);
  if (pending.singular) {
    progress.pending = 0;
    return progress;
  }
  const FactorChanges& changes = pending.changes;
  const bool at_work = pending.batch.computed > 0;
  list_changes(at_work ? pending.factor : *choose_base(body), body.set, pending.changes);
  for (bool holds = true; holds && changes.missing + changes.removed > 0;) {
    holds = continue_changes(body, whole, allowance, progress.work);
    list_changes(pending.factor, body.set, pending.changes);
  }
  progress.pending = pending.singular ? 0 : left_of(body, whole);
  if (progress.pending == 0 && !pending.singular) {
    drop_batch(body);
    hand_over(body);
  }
  return progress;
}

std::uint64_t drop_batch_work(const PendingFactor& pending) noexcept {
  return pending.batch.computed > 0 ? 2 * pending.counts.coefficients : 0;
}

void drop_batch(Body& body) noexcept {
  PendingFactor& pending = body.pending;
  if (pending.batch.computed > 0) {
    release_capacitance(pending.batch, body.capacitance);
    clear(pending.touched);
    pending.batch.computed = 0;
    pending.spent = 0;
  }
}

}  // namespace greenloop
