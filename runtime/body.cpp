#include "runtime/body.hpp"

#include <cfloat>
#include <new>

#include "runtime/lu.hpp"

namespace greenloop {
namespace {

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
          sum += lift < 0 ? -lift : lift;
        }
      }
      most = sum > most ? sum : most;
    }
    growth += most + 1;
  }
  return 2 * growth;
}

double largest_coefficient(const ModelView& view) {
  double largest = 0;
  for (std::uint32_t c = 0; c < view.levels; ++c) {
    for (std::uint32_t r = 0; r < view.levels && view.level[c].counts->column_count > 0; ++r) {
      const BlocksView& blocks = view.blocks[c][r];
      const double most = blocks.value_bytes == 1 ? 128 : 32768;
      for (std::uint32_t j = 0; j < blocks.columns; ++j) {
        largest = most * blocks.scale[j] > largest ? most * blocks.scale[j] : largest;
      }
    }
  }
  return largest;
}

float largest_force_sum(const ModelView& view, const Lifting& lifting) {
  const double per_newton = transform_growth(view, lifting) * largest_coefficient(view);
  const double limit = FLT_MAX / 4.0 / (per_newton > 1 ? per_newton : 1);
  return static_cast<float>(limit);
}

// exact lengths of the functionals that requirement.hpp only bounds
void measure_functionals(const ModelView& view, Body& body, std::uint32_t* const* functional_size) {
  for (std::uint32_t c = 0; c < view.levels; ++c) {
    const LevelView& level = view.level[c];
    for (std::uint32_t j = 0; j < level.counts->column_count; ++j) {
      functional_size[c][j] =
          point_functional(view, body.lifting, level.columns[j].node, body.capacitance.coefficients);
    }
  }
}

}  // namespace

Body* place_body(Arena& arena, const ModelView& view, const BodySizes& sizes) noexcept {
  auto* memory = arena.take<Body>(1);
  Body body;
  std::uint32_t* begin[layout::max_levels] = {};
  OddNeighbours* neighbours[layout::max_levels] = {};
  std::uint32_t* functional_size[layout::max_levels] = {};
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    if (q > 0) {
      begin[q] = arena.take<std::uint32_t>(domain_up_to(view, q - 1) + std::uint64_t{1});
      neighbours[q] = arena.take<OddNeighbours>(sizes.lifting_records[q]);
    }
    functional_size[q] = arena.take<std::uint32_t>(view.level[q].counts->column_count);
    body.lifting.begin[q] = begin[q];
    body.lifting.neighbours[q] = neighbours[q];
    body.functional_size[q] = functional_size[q];
  }
  body.facts = arena.take<NodeFacts>(view.node_count);
  body.set.column = arena.take<std::uint32_t>(sizes.set_columns);
  body.set.sorting = arena.take<std::uint32_t>(sizes.set_columns);
  body.set.members = arena.take<std::uint32_t>(sizes.set_columns);
  body.set.place = arena.take<std::uint32_t>(sizes.counts.max_contacts);
  body.set.place_of_column = arena.take<std::uint32_t>(sizes.level_columns);
  body.capacitance.blocks = arena.take_zeroed<Block>(view.node_count);
  body.capacitance.coefficients =
      arena.take<PointCoefficient>(std::uint64_t{sizes.set_columns} * sizes.longest_functional);
  body.capacitance.begin = arena.take<std::uint32_t>(sizes.set_columns + std::uint64_t{1});
  body.force = arena.take<Float4>(lu_padded(3 * sizes.set_columns) / 4);
  body.cache.carve(arena, sizes.counts.cached_factors, sizes.set_columns);
  if (memory == nullptr) {
    return nullptr;
  }

  for (std::uint32_t q = 1; q < view.levels; ++q) {
    list_odd_neighbours(view, q, begin[q], neighbours[q]);
  }
  list_node_facts(view, body.facts);
  for (std::uint32_t j = 0; j < sizes.level_columns; ++j) {
    body.set.place_of_column[j] = layout::none;
  }
  measure_functionals(view, body, functional_size);
  body.view = &view;
  body.counts = sizes.counts;
  body.force_limit = largest_force_sum(view, body.lifting);
  body.last_red_zone = arena.last_red_zone();
  return new (memory) Body(body);
}

}  // namespace greenloop
