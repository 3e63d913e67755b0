#include "runtime/elastostatic/step_work.hpp"

#include "runtime/algebra/cholesky.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/glide.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

std::uint64_t smaller(std::uint64_t a, std::uint64_t b) { return a < b ? a : b; }

// most coefficients of level q that forces on `nodes` nodes of K(c) touch
std::uint64_t most_touched(const ModelView& view, const ReachBound& reach, std::uint32_t q, std::uint64_t nodes) {
  return smaller(view.level[q].counts->domain_count, nodes * reach.coefficients[q]);
}

// most blocks that some coefficients have with a level
std::uint64_t most_blocks(const LevelPair& pair, std::uint64_t coefficients) {
  return smaller(pair.all, coefficients * pair.most);
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
  return solve_work(prices, set.contacts, set.columns) + Glide::blend_work(prices, set.contacts);
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

MostCounts most_counts(const ModelView& view, const CouplingCounts& couplings, std::uint32_t c,
                       std::uint32_t max_contacts, const ReachBound& reach, const BaseColumns& base) noexcept {
  MostCounts most;
  SetCounts& counts = most.set;
  counts.bounds = true;
  counts.contacts = max_contacts;
  counts.columns = smaller(domain_up_to(view, c), max_contacts);
  counts.visits = counts.columns * reach.visits;
  counts.column.visits = counts.visits;
  for (std::uint32_t q = 0; q <= c; ++q) {
    const std::uint64_t of_set = most_touched(view, reach, q, counts.columns);
    const std::uint64_t of_column = most_touched(view, reach, q, 1);
    counts.coefficients += of_set;
    counts.column.coefficients += counts.columns * of_column;
    for (std::uint32_t other = 0; other <= c; ++other) {
      counts.stored += other <= q ? most_blocks(couplings.stored[q][other], of_set) : 0;
      counts.column.blocks += counts.columns * most_blocks(couplings.stored[q][other], of_column);
    }
    std::uint64_t blocks = of_set;  // on the diagonal
    for (std::uint32_t other = 0; other < view.levels; ++other) {
      const std::uint64_t tiles = q == 0 && base.columns > 0 ? tiles_of(domain_up_to(view, other)) : 0;
      blocks += most_blocks(couplings.stored[q][other], of_set);
      most.field_blocks[other] += blocks + of_set * tiles * FieldBlocks::of_tile<3>;
    }
  }
  counts.slots = counts.coefficients;
  return most;
}

}  // namespace greenloop
