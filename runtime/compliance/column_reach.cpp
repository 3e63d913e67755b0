#include "runtime/compliance/column_reach.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

#include "runtime/algebra/value_counts.hpp"
#include "runtime/compliance/base_columns.hpp"
#include "runtime/compliance/capacitance_work.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/point_support.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t most_even = 576;

[[gnu::noinline]] std::uint32_t largest_degree(const ModelView& view, std::uint32_t level, std::uint32_t with) {
  ValueCounts<> blocks;
  count_blocks(view, level, {with, with}, {}, blocks);
  return static_cast<std::uint32_t>(blocks.most());
}

// the domain nodes of K(level) that a column's force is shared among
class Descent {
 public:
  explicit Descent(const ModelView& view) : view_(view), supports_{limit(), limit()} {}

  void begin(std::uint32_t column) {
    here().clear();
    here().add(domain_node(view_, column_place(column)));
  }
  // to the next coarser level
  void step(std::uint32_t level) {
    static_cast<void>(coarsen(view_, level, here(), supports_[1 - at_]));
    at_ = 1 - at_;
  }
  PointSupport& here() { return supports_[at_]; }

 private:
  [[nodiscard]] PointSupport limit() const { return PointSupport(most_support(view_)); }

  const ModelView& view_;
  PointSupport supports_[2];
  std::size_t at_ = 0;
};

void add_coefficient(std::uint32_t level, std::uint32_t place, const Degrees& degrees, Places& reached, Reach& reach) {
  ++reach.coefficients[level];
  degrees.add(level, place, reach.blocks);
  reached.add(place);
}

bool is_lifted(const layout::RefinementRecord& record) { return record.lift[0] != 0 || record.lift[1] != 0; }

// the nodes of M(level) in a support: those that are coefficients whatever lifts them; the number of all
std::uint32_t add_odd_nodes(const ModelView& view, std::uint32_t level, const PointSupport& support,
                            const Degrees& degrees, Places& reached, Reach& reach) {
  const LevelView& at = view.level[level];
  std::uint32_t odd = 0;
  for (std::uint32_t k = 0; k < support.count(); ++k) {
    if (support.node(k) < at.node_begin) {
      continue;
    }
    ++odd;
    if (level == 0 || !is_lifted(at.refinement[support.node(k) - at.node_begin])) {
      add_coefficient(level, domain_place(view, level, support.node(k)), degrees, reached, reach);
    }
  }
  return odd;
}

// as many lifted coefficients as some even nodes may have, of the largest counts
void add_unlisted(const ModelView& view, std::uint32_t level, const LiftingCounts& lifting, const Degrees& degrees,
                  Reach& reach) {
  const std::uint32_t most = view.level[level].counts->domain_count - reach.coefficients[level];
  const std::uint32_t count = std::min(most, reach.even[level] * lifting.most_neighbours);
  reach.coefficients[level] += count;
  for (std::uint32_t with = 0; with < degrees.levels; ++with) {
    reach.blocks[with] += count * degrees.most[level][with];
  }
}

[[gnu::noinline]] void follow_column(const ModelView& view, std::uint32_t column, const LiftingCounts* lifting,
                                     const Degrees& degrees, Places& reached, Reach& reach) {
  Descent descent(view);
  descent.begin(column);
  for (std::uint32_t level = column_level(column); level > 0; --level) {
    reach.forced[level] = add_odd_nodes(view, level, descent.here(), degrees, reached, reach);
    descent.step(level);
    reach.even[level] = descent.here().count();
    if (lifting[level].most_neighbours > 0 && !lists_neighbours(view, level)) {
      add_unlisted(view, level, lifting[level], degrees, reach);
    }
  }
  add_odd_nodes(view, 0, descent.here(), degrees, reached, reach);
}

// which of the columns have a force on the coarser nodes, a bit each. of_even: [domain of K(level-1)]
[[gnu::noinline]] void mark_even(const ModelView& view, std::uint32_t level, const ReachBatch& batch,
                                 std::uint8_t* of_even) {
  Descent descent(view);
  for (std::uint32_t k = 0; k < batch.count; ++k) {
    descent.begin(batch.column[k]);
    for (std::uint32_t l = column_level(batch.column[k]); l >= level; --l) {
      descent.step(l);
    }
    for (std::uint32_t n = 0; n < descent.here().count(); ++n) {
      of_even[domain_place(view, descent.here().node(n))] |= static_cast<std::uint8_t>(1U << k);
    }
  }
}

// the coefficients of M(level) that are lifted into nodes with a force
[[gnu::noinline]] void add_neighbours(const ModelView& view, std::uint32_t level, const Degrees& degrees,
                                      ReachBatch& batch, Places& reached) {
  std::uint8_t of_even[most_even] = {};
  mark_even(view, level, batch, of_even);
  const LevelView& at = view.level[level];
  for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
    std::uint32_t columns = 0;
    for (int side = 0; side < 2; ++side) {
      const layout::RefinementRecord& record = at.refinement[i];
      columns |= record.lift[side] != 0 ? of_even[domain_place(view, record.parent[side])] : 0U;
    }
    for (; columns != 0; columns &= columns - 1) {
      add_coefficient(level, at.domain_begin + i, degrees, reached, batch.reach[std::countr_zero(columns)]);
    }
  }
}

}  // namespace

void Degrees::add(std::uint32_t level, std::uint32_t place, std::uint32_t* blocks) const noexcept {
  for (std::uint32_t with = 0; with < levels; ++with) {
    blocks[with] += place < exact ? first[levels * place + with] : most[level][with];
  }
}

void fill_degrees(const ModelView& view, std::uint32_t c, Degrees& degrees) noexcept {
  degrees.levels = c + 1;
  const bool fits = view.domain_count <= UINT16_MAX;  // no coefficient has more than one block with another
  degrees.exact = fits ? std::min(domain_up_to(view, c), Degrees::entries / degrees.levels) : 0;
  for (std::uint32_t q = 0; q <= c; ++q) {
    visit_degrees(view, q, degrees.exact, [&degrees](std::uint32_t coefficient, std::uint32_t with) {
      ++degrees.first[degrees.levels * coefficient + with];
    });
    for (std::uint32_t with = 0; with <= c && domain_up_to(view, q) > degrees.exact; ++with) {
      degrees.most[q][with] = largest_degree(view, q, with);
    }
  }
}

void follow(const ModelView& view, const LiftingCounts* lifting, const Degrees& degrees, ReachBatch& batch,
            Places& reached) noexcept {
  for (std::uint32_t k = 0; k < batch.count; ++k) {
    follow_column(view, batch.column[k], lifting, degrees, reached, batch.reach[k]);
  }
  for (std::uint32_t level = degrees.levels - 1; level > 0; --level) {
    if (lifting[level].most_neighbours > 0 && lists_neighbours(view, level)) {
      add_neighbours(view, level, degrees, batch, reached);
    }
  }
}

bool lists_neighbours(const ModelView& view, std::uint32_t level) noexcept {
  return domain_up_to(view, level - 1) <= most_even;
}

}  // namespace greenloop
