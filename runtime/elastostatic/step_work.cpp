#include "runtime/elastostatic/step_work.hpp"

#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/compliance/selected_columns.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/glide.hpp"
#include "runtime/elastostatic/mixed_contacts.hpp"
#include "runtime/elastostatic/unilateral.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

std::uint64_t smaller(std::uint64_t a, std::uint64_t b) { return a < b ? a : b; }

// a bound for each of the constraint levels that touch a level's coefficients
template <class Visit>
void visit_touching(const ModelView& view, std::uint32_t q, MostCounts* most_of, Visit visit) {
  const std::uint32_t coarsest = view.info->coarsest_constraint_level;
  for (std::uint32_t c = q > coarsest ? q : coarsest; c < view.levels; ++c) {
    visit(most_of[c]);
  }
}

[[gnu::noinline]] void add_stored(const ModelView& view, std::uint32_t q, MostCounts* most_of) {
  ValueCounts<> stored;
  count_stored(view, q, stored);
  visit_touching(view, q, most_of, [&](MostCounts& most) { most.set.stored += stored.largest(most.touched[q]); });
}

// blocks that forces on level q's coefficients are summed with to move levels 0..details
[[gnu::noinline]] void add_field_blocks(const ModelView& view, const BaseColumns& base, std::uint32_t q,
                                        std::uint32_t details, std::uint64_t MostCounts::*field_blocks,
                                        MostCounts* most_of) {
  ValueCounts<> blocks;
  count_blocks(view, q, {0, details}, base, blocks);
  const std::uint32_t tiles = q == 0 && base.columns > 0 ? tiles_of(domain_up_to(view, details)) : 0;
  const std::uint64_t diagonal = q <= details ? 1 : 0;
  const std::uint64_t of_each = diagonal + std::uint64_t{tiles} * FieldBlocks::of_tile<3>;
  visit_touching(view, q, most_of, [&](MostCounts& most) {
    most.*field_blocks += blocks.largest(most.touched[q]) + most.touched[q] * of_each;
  });
}

}  // namespace

std::uint64_t resolve_work(const ModelCounts& model, const SetCounts& set) noexcept {
  return priced(1, model.prices.level) + resolve_contacts_work(model.prices, set.contacts) +
         priced(set.columns, model.prices.resolved_column) +
         FactorCache::find_work(model.prices, model.cached_factors, set.columns);
}

std::uint64_t older_forces_work(const ModelCounts& model, std::uint64_t contacts) noexcept {
  return resolve_contacts_work(model.prices, contacts) +
         FactorCache::find_work(model.prices, model.cached_factors, contacts) +
         solve_work(model.prices, contacts, contacts);
}

std::uint64_t solve_work(const Prices& prices, std::uint64_t contacts, std::uint64_t columns) noexcept {
  return priced(contacts, prices.solved_contact) + priced(columns, prices.solved_column) +
         cholesky_solve_work(prices, static_cast<std::uint32_t>(3 * columns));
}

std::uint64_t force_work(const Prices& prices, const SetCounts& set) noexcept {
  const std::uint64_t solving = set.corners == 0 ? solve_work(prices, set.contacts, set.columns)
                                : set.rows > 0   ? mixed_work(prices, set.corners, set.rows)
                                                 : unilateral_work(prices, set.corners, set.iterations);
  return solving + Glide::blend_work(prices, set.contacts);
}

std::uint64_t plan_loads_work(const ModelCounts& model, const SetCounts& set, const LoadCounts& loads) noexcept {
  return priced(loads.forces.columns, model.prices.resolved_contact) + touch_work(model.prices, loads.forces) +
         count_field_work(model.prices, set) + count_field_work(model.prices, loads.forces);
}

std::uint64_t most_coupling_blocks(const SetCounts& set, const LoadCounts& loads) noexcept {
  return smaller(loads.set_stored + loads.forces.stored, set.coefficients * loads.forces.coefficients);
}

std::uint64_t displace_by_loads_work(const ModelCounts& model, const SetCounts& set, const LoadCounts& loads,
                                     std::uint64_t between) noexcept {
  const Prices& prices = model.prices;
  const SetCounts& forces = loads.forces;
  const bool coupled = forces.columns > 0;
  const CoupledCounts both{set.coefficients + forces.coefficients, loads.set_stored + forces.stored};
  return priced(set.columns + forces.columns, prices.force_column) +
         priced(set.visits + forces.visits, force_visit_price(prices, model.prediction)) +
         priced(loads.amounts * set.coefficients, prices.scaled_sum) +
         (coupled ? couple_work(prices, both, between) : 0);
}

std::uint64_t ask_work(const ModelCounts& model, const SetCounts& points, const LoadCounts& loads) noexcept {
  return touch_work(model.prices, points) + touch_work(model.prices, loads.forces);
}

std::uint64_t load_field_work(const ModelCounts& model, const LoadCounts& loads, std::uint32_t details,
                              std::uint64_t blocks) noexcept {
  const Prices& prices = model.prices;
  return priced(loads.forces.columns, prices.force_column) +
         priced(loads.forces.visits, force_visit_price(prices, model.prediction)) +
         priced(loads.forces.coefficients, prices.coefficient) + priced(blocks, prices.summed_block) +
         priced(loads.amounts * model.rows[details], prices.scaled_sum);
}

std::uint64_t field_work(const ModelCounts& model, const SetCounts& set, const FieldLevels& levels,
                         std::uint64_t blocks) noexcept {
  const Prices& prices = model.prices;
  const std::uint64_t details = model.rows[levels.details];
  return priced(1, prices.field) + priced(set.columns + set.contacts, prices.force_column) +
         priced(set.visits, force_visit_price(prices, model.prediction)) +
         priced(set.coefficients, prices.coefficient) + priced(blocks, prices.summed_block) +
         priced(details, prices.scaled_sum) +
         inverse_transform_work(model.nodes[levels.nodes], model.rows[levels.nodes] - model.rows[0], details, prices,
                                model.prediction);
}

std::uint64_t count_field_blocks(const FieldBlocks& blocks, const Touched& touched,
                                 std::uint32_t field_level) noexcept {
  std::uint64_t sum = 0;
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      sum += blocks.count(touched.list[q][k], field_level);
    }
  }
  return sum;
}

std::uint64_t count_stored(const std::uint32_t* stored, const Touched& touched) noexcept {
  std::uint64_t sum = 0;
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      sum += stored[touched.list[q][k]];
    }
  }
  return sum;
}

SetCounts most_point_counts(const ModelView& view, std::uint64_t columns, const ReachBound& reach,
                            const LiftingCounts* lifting) noexcept {
  SetCounts most;
  most.columns = most.visits = columns;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const std::uint64_t touched = smaller(view.level[q].counts->domain_count, columns * reach.coefficients[q]);
    ValueCounts<> stored;
    count_stored(view, q, stored);
    most.coefficients += touched;
    most.stored += stored.largest(touched);
    most.visits +=
        (q > 0 ? prediction_of(view).length * touched : 0) + std::uint64_t{OddNeighbours::most} * lifting[q].records;
  }
  return most;
}

MostCounts most_counts(const ModelView& view, std::uint32_t c, std::uint32_t max_contacts, const ColumnBounds& bounds,
                       const LiftingCounts* lifting) noexcept {
  const std::uint64_t length = prediction_of(view).length;
  MostCounts most;
  SetCounts& counts = most.set;
  counts.bounds = true;
  counts.contacts = max_contacts;
  counts.columns = smaller(bounds.columns, max_contacts);
  counts.column = {counts.columns * bounds.all_coefficients, bounds.meetings, counts.columns * bounds.visits};
  counts.visits = counts.columns;
  for (std::uint32_t q = 0; q <= c; ++q) {
    most.touched[q] = bounds.touched[q];
    counts.coefficients += most.touched[q];
    // a coefficient of level 0 is predicted by none, and without lifting a force is on every other one
    const std::uint64_t forced = q > 0 ? smaller(most.touched[q], counts.columns * bounds.forced[q]) : 0;
    const std::uint64_t listed = std::uint64_t{OddNeighbours::most} * lifting[q].records;
    counts.visits += length * forced + smaller(listed, neighbour_visits(lifting[q], counts.columns * bounds.even[q]));
  }
  counts.slots = counts.coefficients;
  return most;
}

MostCounts most_force_counts(const ModelView& view, std::uint32_t c, const ModelCounts& model,
                             const ColumnBounds& bounds, const LiftingCounts* lifting) noexcept {
  MostCounts most = most_counts(view, c, model.max_forces, bounds, lifting);
  most.set.visits += model.max_forces - most.set.columns;
  most.set.columns = model.max_forces;
  return most;
}

void add_blocks(const ModelView& view, const BaseColumns& base, MostCounts* most_of) noexcept {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    add_stored(view, q, most_of);
    add_field_blocks(view, base, q, view.levels - 1, &MostCounts::field_blocks, most_of);
    add_field_blocks(view, base, q, 0, &MostCounts::least_field_blocks, most_of);
  }
}

}  // namespace greenloop
