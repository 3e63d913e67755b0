#include "runtime/elastostatic/body.hpp"

#include <cfloat>
#include <cstring>
#include <new>

#include "formats/stored_blocks.hpp"
#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/elastostatic/inputs.hpp"
#include "runtime/elastostatic/planner.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

double magnitude(double value) { return value < 0 ? -value : value; }

double larger(double a, double b) { return a > b ? a : b; }

// largest sum of the magnitudes of what one component of a node of a level is predicted with, which is also what one of
// a force on it is shared with
double prediction_sum(const ModelView& view, const Prediction& prediction, std::uint32_t level) {
  if (!prediction.blocks) {
    return prediction.length > 2 ? 1.5 : 1;
  }
  const LevelView& at = view.level[level];
  double most = 0;
  for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
    double sum[3] = {};
    for (std::uint32_t k = 0; k < 9 * at.predictions.terms; ++k) {
      const std::size_t term = std::size_t{at.predictions.terms} * i + k / 9;
      sum[k % 3] += magnitude(double{layout::prediction_unit} * stored_weight<3>(at.predictions, term, k % 9));
    }
    most = larger(most, larger(sum[0], larger(sum[1], sum[2])));
  }
  return most;
}

// largest factor between coefficients and node values, intermediate sums included
double transform_growth(const ModelView& view, const Prediction& prediction, const Lifting& lifting) {
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
    growth = larger(growth, prediction_sum(view, prediction, level) * (growth + 2 * most)) + 2;
  }
  return 2 * growth / (prediction.blocks ? double{weight_unit<3>} : 1);
}

// largest factor between the sum of nodal forces and force coefficients
double force_growth(const ModelView& view, const Prediction& prediction) {
  double most = 0;
  double sum = 1;
  for (std::uint32_t level = 1; level < view.levels; ++level) {
    sum *= larger(1, prediction_sum(view, prediction, level));
    for (std::uint32_t i = 0; i < view.level[level].counts->domain_count; ++i) {
      const float* lift = view.level[level].refinement[i].lift;
      most = larger(most, magnitude(double{lift[0]}) + magnitude(double{lift[1]}));
    }
  }
  return sum * (1 + most);
}

// magnitudes within a part of the scales
template <class Part>
double largest_scale(const ModelView& view, Part part) {
  double largest = 1;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t i = 0; i < view.level[q].counts->domain_count; ++i) {
      for (const float value : view.level[q].scales_of<3>()[i].*part) {
        largest = larger(largest, magnitude(double{value}));
      }
    }
  }
  return largest;
}

// largest sum of the couplings' values, and the diagonal's, between two coefficients
double largest_value(const ModelView& view) {
  double sum = largest_scale(view, &layout::Scale<3>::diagonal);
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    sum += double{view.info->quantum[layer]} * (1U << (layout::value_bits[layer] - 1));
  }
  return sum;
}

float largest_force_sum(const ModelView& view, const Lifting& lifting) {
  const double root = 3 * largest_scale(view, &layout::Scale<3>::root);
  const double sums = 3.0 * view.domain_count * largest_value(view);
  const Prediction prediction = prediction_of(view);
  const double per_newton =
      transform_growth(view, prediction, lifting) * root * sums * root * force_growth(view, prediction);
  return static_cast<float>(FLT_MAX / 4.0 / per_newton);
}

// what is written once, at the start
struct Tables {
  ModelView* view = nullptr;
  FactorTools<3>* factor_tools = nullptr;
  RefinementTables refinement;
  ColumnCost* cost[layout::max_levels] = {};
  std::uint32_t* column_blocks[layout::max_levels] = {};
  PredictionOffsets<3> offsets;
  BaseColumnsMaker<3> base;
  MirroredCouplingsMaker<3> mirrored;
  std::uint8_t* read = nullptr;
  std::uint32_t* field_blocks = nullptr;  // and before they are counted, the degrees that the costs follow from
};

void carve_tables(Arena& arena, const ModelView& view, const BodySizes& sizes, Tables& tables) {
  tables.view = arena.take<ModelView>(1);
  tables.factor_tools = arena.take<FactorTools<3>>(1);
  tables.refinement.carve(arena, view);
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    tables.cost[c] = arena.take<ColumnCost>(domain_up_to(view, c));
    tables.column_blocks[c] = arena.take<std::uint32_t>((std::uint64_t{1} + c) * domain_up_to(view, c));
  }
  tables.field_blocks = arena.take<std::uint32_t>(std::uint64_t{view.domain_count} * view.levels);
  if (sizes.counts.forces_only) {
    return;
  }
  tables.offsets.carve(arena, view);
  tables.base.carve(arena, view);
  tables.mirrored.carve(arena, view, tables.base.columns());
  tables.read = arena.take<std::uint8_t>(view.domain_count);
}

LoadState* carve_loads(Arena& arena, const ModelView& view, const BodySizes& sizes) {
  auto* const memory = arena.take<LoadState>(1);
  LoadState counted;
  LoadState& loads = memory == nullptr ? counted : *new (memory) LoadState;
  loads.forces.carve(arena, view, sizes.counts.max_forces);
  loads.load = arena.take<std::uint32_t>(sizes.counts.model_loads);
  loads.amount = arena.take<float>(sizes.counts.model_loads);
  loads.largest = arena.take<float>(sizes.counts.model_loads);
  loads.held = arena.take<Constraint>(sizes.counts.max_contacts);
  loads.held_force = arena.take<float>(std::uint64_t{3} * sizes.counts.max_contacts);
  loads.column_displaced = arena.take<float>(std::uint64_t{3} * sizes.set_columns);
  loads.displaced = arena.take_zeroed<Float4>(view.domain_count);
  if (sizes.counts.max_points > 0) {
    const std::uint64_t forced = std::uint64_t{sizes.counts.max_contacts} + sizes.counts.max_forces;
    loads.point_column = arena.take<std::uint32_t>(std::uint64_t{3} * sizes.counts.max_points);
    loads.asked_column = arena.take<std::uint32_t>(forced);
    loads.asked_force = arena.take<float>(3 * forced);
  }
  return memory;
}

void carve(Arena& arena, const ModelView& view, const BodySizes& sizes, Body& body, Tables& tables) {
  carve_tables(arena, view, sizes, tables);
  if (!sizes.counts.forces_only) {
    const std::uint32_t tiles = tables.base.columns().tiles;
    const std::uint64_t places = std::uint64_t{BaseColumns::width} * tiles_of(view.domain_count);
    body.field_sums.of_blocks = arena.take_zeroed<Float4>(places);
    body.field_sums.of_tiles = tiles > 0 ? arena.take_zeroed<TileSums<3>>(tiles) : nullptr;
  }
  body.stored = arena.take<std::uint32_t>(view.domain_count);
  body.facts = arena.take<NodeFacts>(view.node_count);
  body.resolution.carve(arena, sizes.counts.max_contacts, view.domain_count);
  body.planned.carve(arena, sizes.counts.max_contacts);
  body.other.carve(arena, sizes.counts.max_contacts);
  body.touched.carve(arena, view);
  const std::uint64_t entries = sizes.set_columns * sizes.functional;
  body.capacitance.carve(arena, view, {sizes.set_columns, entries, sizes.slots, sizes.longest_column},
                         sizes.counts.prediction);
  body.factoring.carve<3>(arena, sizes.set_columns);
  body.column_force = arena.take<float>(std::uint64_t{3} * sizes.set_columns);
  body.other_column_force = arena.take<float>(std::uint64_t{3} * sizes.set_columns);
  body.older_force = arena.take<float>(std::uint64_t{3} * sizes.counts.max_contacts);
  body.solution = arena.take<Float4>(padded_order(3 * sizes.set_columns) / 4);
  body.force = arena.take_zeroed<Float4>(view.domain_count);
  if (sizes.counts.takes_loads() || sizes.counts.max_points > 0 || sizes.counts.mixed_contacts) {
    body.loads = carve_loads(arena, view, sizes);
  }
  body.cache.carve<3>(arena, sizes.counts.cached_factors, sizes.set_columns, sizes.counts.keeps_capacitance);
  body.job.carve<3>(arena, view, sizes.set_columns, sizes.counts.keeps_capacitance);
  body.last.carve(arena, sizes.counts.max_contacts, view.node_count);
  body.glide.carve(arena, sizes.counts.max_contacts, sizes.counts.glide_cycles);
  if (sizes.counts.iterations > 0) {
    body.unilateral.carve(arena, sizes.counts.max_contacts, view.node_count, sizes.counts.prices);
  }
  if (sizes.counts.mixed_contacts) {
    body.mixed.carve(arena, sizes.counts.max_contacts, view.node_count, sizes.counts.glide_cycles);
  }
  body.accepted = arena.take<Accepted>(1);
  body.plan = arena.take<Plan>(1);
}

void count_stored(const ModelView& view, std::uint32_t* stored) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      stored[level.domain_begin + i] = 0;
      for (const CouplingsView& couplings : level.couplings) {
        stored[level.domain_begin + i] += column_length(couplings, i);
      }
    }
  }
}

void fill_costs(const ModelView& view, const Tables& tables, Body& body) {
  std::uint32_t* const degree = tables.field_blocks;
  std::memset(degree, 0, sizeof(std::uint32_t) * view.domain_count * view.levels);
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    visit_degrees(view, q, view.domain_count, [&](std::uint32_t coefficient, std::uint32_t with) {
      ++degree[std::size_t{view.levels} * coefficient + with];
    });
  }
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    for (std::uint32_t place = 0; place < domain_up_to(view, c); ++place) {
      tables.cost[c][place] = column_cost(body.refinement, make_column(c, place), degree, body.touched,
                                          tables.column_blocks[c] + std::size_t{c + 1} * place);
    }
    body.cost.level[c] = tables.cost[c];
    body.cost.blocks[c] = tables.column_blocks[c];
  }
}

void fill_tables(const ModelView& view, Tables& tables, Body& body) {
  tables.refinement.fill(view);
  list_node_facts(view, body.facts);
  count_stored(view, body.stored);
  fill_costs(view, tables, body);
  for (std::uint32_t j = 0; j < view.domain_count; ++j) {
    body.resolution.index_of_place[j] = layout::none;
    body.capacitance.slot[j] = layout::none;
  }
}

// false if a ready file leaves out other blocks than those that move nothing that is read
bool prepare_fields(const ModelView& view, Tables& tables, Body& body) {
  tables.offsets.fill(view);
  body.offsets = tables.offsets;
  mark_read(body.refinement, body.touched, tables.read);
  if (view.ready.read != nullptr && std::memcmp(view.ready.read, tables.read, view.domain_count) != 0) {
    return false;
  }
  body.base = tables.base.make(view);
  body.mirrored = tables.mirrored.make(view, body.base, tables.read);
  count_field_blocks<3>(view, body.mirrored, body.base, tables.field_blocks);
  body.field_blocks = {view.levels, tables.field_blocks};
  body.block_sums = fastest_block_sums<3>();
  body.add_tiles = fastest_add_tiles<3>();
  return true;
}

}  // namespace

Body* place_body(Arena& arena, const ModelView& view, const BodySizes& sizes) noexcept {
  Tables tables;
  auto* memory = arena.take<Body>(1);
  if (memory == nullptr) {
    Body counted;
    carve(arena, view, sizes, counted, tables);
    return nullptr;
  }
  Body& body = *new (memory) Body;
  carve(arena, view, sizes, body, tables);
  *tables.view = view;
  body.view = tables.view;
  body.counts = sizes.counts;
  body.capacitance.prices = &body.counts.prices;
  body.refinement = tables.refinement.refinement(*body.view, body.lifting);
  body.tools =
      new (tables.factor_tools) FactorTools<3>{body.counts,    body.refinement, body.cost,
                                               body.stored,    body.cache,      body.capacitance,
                                               body.factoring, body.force,      body.resolution.index_of_place};
  fill_tables(view, tables, body);
  if (!body.counts.forces_only && !prepare_fields(view, tables, body)) {
    return nullptr;
  }
  body.force_limit = largest_force_sum(view, body.lifting);
  const double growth = body.counts.model_loads > 0 ? transform_growth(view, prediction_of(view), body.lifting) : 0;
  for (std::uint32_t k = 0; k < body.counts.model_loads; ++k) {
    body.loads->largest[k] = static_cast<float>(growth * largest_coefficient(view, k));
  }
  body.last_red_zone = arena.last_red_zone();
  return &body;
}

}  // namespace greenloop
