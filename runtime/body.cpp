#include "runtime/body.hpp"

#include <cfloat>
#include <new>

#include "runtime/cholesky.hpp"
#include "runtime/domain.hpp"

namespace greenloop {
namespace {

double magnitude(double value) { return value < 0 ? -value : value; }

double larger(double a, double b) { return a > b ? a : b; }

// largest factor between coefficients and node values, intermediate sums included
double transform_growth(const ModelView& view, const Lifting& lifting) {
  double growth = 1;
  for (std::uint32_t level = 1; level < view.levels; ++level) {
    const std::uint32_t* begin = lifting.begin[level];
    double most = 0;
    for (std::uint32_t e = 0; e < domain_up_to(view, level - 1); ++e) {
      double sum = 0;
      for (std::uint32_t n = begin[e]; n < begin[e + 1]; ++n) {
        for (const float lift : lifting.neighbours[level][n].lift) {
          sum += magnitude(double{lift});
        }
      }
      most = larger(most, sum);
    }
    // values of the level before, its averages, and the details
    growth += 2 * (most + 1);
  }
  return 2 * growth;
}

// largest factor between nodal forces, whose sum no level exceeds, and force coefficients
double force_growth(const ModelView& view) {
  double most = 0;
  for (std::uint32_t level = 1; level < view.levels; ++level) {
    for (std::uint32_t i = 0; i < view.level[level].counts->domain_count; ++i) {
      const float* lift = view.level[level].refinement[i].lift;
      most = larger(most, magnitude(double{lift[0]}) + magnitude(double{lift[1]}));
    }
  }
  return 1 + most;
}

double largest_root(const Coefficients& coefficients) {
  double largest = 0;
  for (const CoefficientGroup& group : coefficients.group) {
    for (std::uint32_t i = 0; i < group.count; ++i) {
      for (const float value : group.scale[i].root) {
        largest = larger(largest, magnitude(double{value}));
      }
    }
  }
  return largest;
}

// largest stored value, or 1 for the diagonal
double largest_value(const Couplings& couplings) {
  double largest = 1;
  for (std::uint32_t s = 0; s < couplings.count; ++s) {
    const CouplingsView& view = couplings.section[s].view;
    const double most = view.value_bits == 4 ? 8 : (view.value_bits == 8 ? 128 : 32768);
    largest = larger(largest, most * view.quantum);
  }
  return largest;
}

float largest_force_sum(const ModelView& view, const Body& body) {
  const double root = larger(3 * largest_root(body.coefficients), 1);
  // a coefficient gets at most one block, or one and its other half, from any other
  const double sums = 6.0 * body.coefficients.count * largest_value(body.couplings);
  const double per_newton = transform_growth(view, body.lifting) * root * sums * root * force_growth(view);
  return static_cast<float>(FLT_MAX / 4.0 / per_newton);
}

}  // namespace

Body* place_body(Arena& arena, const ModelView& view, const BodySizes& sizes) noexcept {
  auto* memory = arena.take<Body>(1);
  if (memory != nullptr) {
    new (memory) Body;
  }
  Body counting;
  Body& body = memory != nullptr ? *memory : counting;
  body.view = &view;
  body.counts = sizes.counts;
  body.coefficients = sizes.coefficients;
  body.couplings = sizes.couplings;
  std::uint32_t* begin[layout::max_levels] = {};
  OddNeighbours* neighbours[layout::max_levels] = {};
  ColumnCost* cost[layout::max_levels] = {};
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    if (q > 0) {
      begin[q] = arena.take<std::uint32_t>(domain_up_to(view, q - 1) + std::uint64_t{1});
      neighbours[q] = arena.take<OddNeighbours>(sizes.lifting_records[q]);
    }
    if (q >= view.info->coarsest_constraint_level) {
      cost[q] = arena.take<ColumnCost>(domain_up_to(view, q));
    }
    body.lifting.begin[q] = begin[q];
    body.lifting.neighbours[q] = neighbours[q];
    body.cost[q] = cost[q];
  }
  auto* parents = arena.take<DomainParents>(view.domain_count);
  auto* mesh_level = arena.take<std::uint8_t>(view.domain_count);
  body.refinement = {&view, &body.lifting, parents, mesh_level};
  place_mirrored(arena, body.couplings);
  body.facts = arena.take<NodeFacts>(view.node_count);
  body.set.column = arena.take<std::uint32_t>(sizes.counts.max_contacts);
  body.set.sorting = arena.take<std::uint32_t>(sizes.counts.max_contacts);
  body.set.members = arena.take<std::uint32_t>(sizes.counts.max_contacts);
  body.set.place = arena.take<std::uint32_t>(sizes.counts.max_contacts);
  body.set.place_of_column = arena.take<std::uint32_t>(view.domain_count);
  body.touched.carve(arena, sizes.coefficients);
  CapacitanceScratch& scratch = body.capacitance;
  scratch.touched.carve(arena, sizes.coefficients);
  scratch.coefficients = arena.take<PointCoefficient>(sizes.set_columns * sizes.functional);
  scratch.functional = arena.take<PointFunctional>(sizes.set_columns);
  scratch.slot = arena.take<std::uint32_t>(sizes.coefficients.count);
  scratch.slotted = arena.take<std::uint32_t>(sizes.coefficients.count);
  scratch.root = arena.take<Block>(sizes.coefficients.count);
  scratch.sum = arena.take<Block>(sizes.coefficients.count);
  scratch.chosen = arena.take<BlockPlace>(sizes.longest_list + std::uint64_t{1});
  body.column_force = arena.take<Float4>(padded_order(3 * sizes.set_columns) / 4);
  body.force = arena.take_zeroed<Float4>(sizes.coefficients.count);
  body.sum = arena.take_zeroed<Float4>(sizes.coefficients.count);
  body.cache.carve(arena, sizes.counts.cached_factors, sizes.set_columns);
  if (memory == nullptr) {
    return nullptr;
  }

  for (std::uint32_t q = 1; q < view.levels; ++q) {
    list_odd_neighbours(view, q, begin[q], neighbours[q]);
  }
  list_parents(view, parents, mesh_level);
  list_node_facts(view, body.facts);
  for (std::uint32_t j = 0; j < view.domain_count; ++j) {
    body.set.place_of_column[j] = layout::none;
  }
  for (std::uint32_t j = 0; j < sizes.coefficients.count; ++j) {
    scratch.slot[j] = layout::none;
  }
  const CapacitanceModel model{body.refinement, body.coefficients, body.couplings};
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    for (std::uint32_t place = 0; place < domain_up_to(view, c); ++place) {
      cost[c][place] = column_cost(model, c, place, body.touched);
    }
  }
  body.force_limit = largest_force_sum(view, body);
  body.last_red_zone = arena.last_red_zone();
  return &body;
}

}  // namespace greenloop
