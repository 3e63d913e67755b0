#include "formats/verify/multigrid/sections.hpp"

namespace greenloop::multigrid {
namespace {

using layout::MultigridInfo;

// most vertices, tetrahedra, blocks: products with them stay far from 2^64
constexpr std::uint32_t most_records = 1U << 28;
constexpr std::uint32_t block_floats = 12;

bool verify_sizes(SectionCheck& check, const MultigridInfo& info) {
  const struct {
    const char* name;
    std::uint32_t value, least, most;
  } sizes[] = {{"levels", info.levels, 1, 1},
               {"strain", info.strain, 0, static_cast<std::uint32_t>(layout::Strain::green)},
               {"vertices", info.vertices, 4, most_records},
               {"free", info.free, 1, info.vertices},
               {"tetrahedra", info.tetrahedra, 1, most_records},
               {"matters", info.matters, 1, layout::most_matters},
               {"shown", info.shown, 0, most_records},
               {"triangles", info.triangles, 0, most_records},
               {"grids", info.grids, 1, layout::most_grids},
               {"coarsest_vertices", info.coarsest_vertices, 1, layout::most_coarsest_vertices}};
  for (const auto& size : sizes) {
    if (!check.require_at_least(size.name, 0, size.value, size.least) ||
        !check.require_at_most(size.name, 0, size.value, size.most)) {
      return false;
    }
  }
  return check.require_equal("components", 0, info.components, 3) &&
         check.require(info.grids > 1 || info.coarsest_vertices == info.free, VerifyRule::inconsistent,
                       "coarsest_vertices", 0, info.coarsest_vertices, info.free);
}

bool verify_numbers(SectionCheck& check, const MultigridInfo& info) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (!check.require_finite("gravity", k, info.gravity[k])) return false;
  }
  // squares and inverse squares of the step are finite in single precision
  return check.require_at_least("time_step", 0, info.time_step, 1.0e-9) &&
         check.require_at_most("time_step", 0, info.time_step, 1.0e6) &&
         check.require_at_least("mass_damping", 0, info.mass_damping, 0) &&
         check.require_at_least("stiffness_damping", 0, info.stiffness_damping, 0) &&
         check.require_at_least("numerical_damping", 0, info.numerical_damping, 0) &&
         check.require_at_most("numerical_damping", 0, info.numerical_damping, 1) &&
         check.require_above("size", 0, info.size, 0);
}

bool verify_finite(SectionCheck& check, const char* field, const float* values, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!check.require_finite(field, i, values[i])) return false;
  }
  return true;
}

bool verify_below(SectionCheck& check, const char* field, const std::uint32_t* values, std::uint64_t count,
                  std::uint32_t end) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!check.require(values[i] < end, VerifyRule::out_of_range, field, i, values[i], end)) return false;
  }
  return true;
}

/// Blocks by columns of four numbers, of which the last are 0.
bool verify_blocks_of(SectionCheck& check, const float* values, std::uint64_t blocks) {
  for (std::uint64_t i = 0; i < blocks * block_floats; ++i) {
    if (!check.require_finite("number", i, values[i])) return false;
    if (i % 4 == 3 && !check.require_equal("number", i, values[i], 0)) return false;
  }
  return true;
}

/// Of `vertices` lists one after another, `end` entries in all.
bool verify_starts(SectionCheck& check, const std::uint32_t* starts, std::uint32_t vertices, std::uint64_t end) {
  if (!check.require_equal("start", 0, starts[0], 0)) return false;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (!check.require(starts[v + 1] >= starts[v], VerifyRule::inconsistent, "start", v + 1, starts[v + 1],
                       starts[v])) {
      return false;
    }
  }
  return check.require_equal("start", vertices, starts[vertices], static_cast<double>(end));
}

/// Ascending, those left of the diagonal before `upper`.
bool verify_row(SectionCheck& check, const GridView& grid, std::uint32_t v) {
  for (std::uint32_t k = grid.row_starts[v]; k < grid.row_starts[v + 1]; ++k) {
    const std::uint32_t column = grid.columns[k];
    const bool ascends = k == grid.row_starts[v] || column > grid.columns[k - 1];
    const bool right = k >= grid.row_uppers[v] ? column > v : column < v;
    if (!check.require(ascends && right, VerifyRule::inconsistent, "column", k, column, v)) return false;
  }
  return true;
}

/// Six times the volume.
double volume_of(const float* points, const std::uint32_t (&vertex)[4]) {
  double edge[3][3];
  for (std::uint32_t a = 0; a < 3; ++a) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      edge[a][i] = static_cast<double>(points[std::size_t{3} * vertex[a + 1] + i]) -
                   static_cast<double>(points[std::size_t{3} * vertex[0] + i]);
    }
  }
  return edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) +
         edge[0][1] * (edge[1][2] * edge[2][0] - edge[1][0] * edge[2][2]) +
         edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
}

}  // namespace

bool verify_info(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(sizeof(MultigridInfo))) return false;
  const auto& info = *section.as<MultigridInfo>();
  context.view.info = &info;
  return verify_sizes(check, info) && check.require_equal("levels", 0, info.levels, context.levels) &&
         verify_numbers(check, info) &&
         check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(info.reserved))),
                       VerifyRule::reserved_not_zero, "reserved", 0, 1, 0);
}

bool verify_level(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(sizeof(layout::MultigridLevelRecord))) return false;
  const auto& level = *section.as<layout::MultigridLevelRecord>();
  return check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(level.reserved))),
                       VerifyRule::reserved_not_zero, "reserved", 0, 1, 0);
}

bool verify_points(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t vertices = context.view.info->vertices;
  if (!check.require_count(vertices)) return false;
  context.view.points = section.as<float>();
  return verify_finite(check, "position", context.view.points, std::uint64_t{3} * vertices);
}

bool verify_tetrahedra(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const MultigridInfo& info = *context.view.info;
  if (!check.require_count(info.tetrahedra)) return false;
  const std::span tetrahedra(section.as<layout::TetrahedronRecord>(), info.tetrahedra);
  context.view.tetrahedra = tetrahedra;
  for (std::uint32_t t = 0; t < info.tetrahedra; ++t) {
    const layout::TetrahedronRecord& record = tetrahedra[t];
    for (const std::uint32_t vertex : record.vertex) {
      if (!check.require(vertex < info.vertices, VerifyRule::out_of_range, "vertex", t, vertex, info.vertices)) {
        return false;
      }
    }
    if (!check.require(record.matter < info.matters, VerifyRule::out_of_range, "matter", t, record.matter,
                       info.matters) ||
        !check.require_above("volume", t, volume_of(context.view.points, record.vertex), 0)) {
      return false;
    }
  }
  return true;
}

bool verify_matters(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t matters = context.view.info->matters;
  if (!check.require_count(matters)) return false;
  context.view.matters = section.as<layout::MatterRecord>();
  for (std::uint32_t i = 0; i < matters; ++i) {
    const layout::MatterRecord& matter = context.view.matters[i];
    // K is definite where mu > 0 and 3 lambda + 2 mu > 0
    if (!check.require_above("mu", i, matter.mu, 0) || !check.require_finite("lambda", i, matter.lambda) ||
        !check.require_above("lambda", i, matter.lambda, -2.0 / 3.0 * static_cast<double>(matter.mu)) ||
        !check.require_above("density", i, matter.density, 0) ||
        !check.require_equal("reserved", i, matter.reserved, 0)) {
      return false;
    }
  }
  return true;
}

bool verify_shown_points(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t shown = context.view.info->shown;
  if (!check.require_count(shown)) return false;
  context.view.shape = section.as<float>();
  return verify_finite(check, "position", context.view.shape, std::uint64_t{3} * shown);
}

bool verify_shown_triangles(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const MultigridInfo& info = *context.view.info;
  if (!check.require_count(info.triangles)) return false;
  context.view.triangles = section.as<std::uint32_t>();
  return verify_below(check, "vertex", context.view.triangles, std::uint64_t{3} * info.triangles, info.shown);
}

bool verify_bindings(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const MultigridInfo& info = *context.view.info;
  if (!check.require_count(info.shown)) return false;
  context.view.bindings = {section.as<layout::BindingRecord>(), info.shown};
  for (const layout::BindingRecord& binding : context.view.bindings) {
    if (!verify_below(check, "vertex", binding.vertex, 4, info.vertices) ||
        !verify_finite(check, "weight", binding.weight, 4)) {
      return false;
    }
  }
  return true;
}

bool verify_grid(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(1)) return false;
  const auto& record = *section.as<layout::GridRecord>();
  GridView& grid = context.view.grid[section.a];
  const MultigridInfo& info = *context.view.info;
  const std::uint32_t vertices = section.a == 0 ? info.free : context.coarser;
  grid.vertices = record.vertices;
  context.blocks = record.blocks;
  context.parents = record.parents;
  context.coarser = record.coarser;
  return check.require_equal("vertices", 0, record.vertices, vertices) &&
         check.require_at_most("blocks", 0, record.blocks, most_records) &&
         check.require_at_most("parents", 0, record.parents, most_records) &&
         check.require_at_least("coarser", 0, record.coarser, 1) &&
         check.require_at_most("coarser", 0, record.coarser, record.vertices) &&
         check.require(section.a + 2U < info.grids || record.coarser == info.coarsest_vertices,
                       VerifyRule::inconsistent, "coarser", 0, record.coarser, info.coarsest_vertices);
}

bool verify_row_starts(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  GridView& grid = context.view.grid[section.a];
  if (!check.require_count(std::uint64_t{grid.vertices} + 1)) return false;
  grid.row_starts = section.as<std::uint32_t>();
  return verify_starts(check, grid.row_starts, grid.vertices, context.blocks);
}

bool verify_row_uppers(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  GridView& grid = context.view.grid[section.a];
  if (!check.require_count(grid.vertices)) return false;
  grid.row_uppers = section.as<std::uint32_t>();
  for (std::uint32_t v = 0; v < grid.vertices; ++v) {
    const std::uint32_t upper = grid.row_uppers[v];
    if (!check.require(upper >= grid.row_starts[v] && upper <= grid.row_starts[v + 1], VerifyRule::out_of_range,
                       "upper", v, upper, grid.row_starts[v + 1])) {
      return false;
    }
  }
  return true;
}

bool verify_columns(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  GridView& grid = context.view.grid[section.a];
  if (!check.require_count(context.blocks)) return false;
  grid.columns = {section.as<std::uint32_t>(), context.blocks};
  if (!verify_below(check, "column", grid.columns.data(), context.blocks, grid.vertices)) return false;
  for (std::uint32_t v = 0; v < grid.vertices; ++v) {
    if (!verify_row(check, grid, v)) return false;
  }
  return true;
}

bool verify_blocks(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(context.blocks)) return false;
  context.view.grid[section.a].blocks = section.as<float>();
  return verify_blocks_of(check, section.as<float>(), context.blocks);
}

bool verify_inverses(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  GridView& grid = context.view.grid[section.a];
  if (!check.require_count(grid.vertices)) return false;
  grid.inverses = section.as<float>();
  return verify_blocks_of(check, grid.inverses, grid.vertices);
}

bool verify_parent_starts(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  GridView& grid = context.view.grid[section.a];
  if (!check.require_count(std::uint64_t{grid.vertices} + 1)) return false;
  grid.parent_starts = section.as<std::uint32_t>();
  return verify_starts(check, grid.parent_starts, grid.vertices, context.parents);
}

bool verify_parents(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(context.parents)) return false;
  GridView& grid = context.view.grid[section.a];
  grid.parents = {section.as<std::uint32_t>(), context.parents};
  return verify_below(check, "parent", grid.parents.data(), context.parents, context.coarser);
}

bool verify_weights(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(context.parents)) return false;
  context.view.grid[section.a].weights = section.as<float>();
  return verify_finite(check, "weight", section.as<float>(), context.parents);
}

bool verify_coarsest_factor(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint64_t order = std::uint64_t{3} * context.view.info->coarsest_vertices;
  const std::uint64_t numbers = order * (order + 1) / 2;
  if (!check.require_count(numbers)) return false;
  const auto* const factor = section.as<double>();
  context.view.coarsest_factor = {factor, static_cast<std::size_t>(numbers)};
  std::uint64_t i = 0;
  for (std::uint64_t row = 0; row < order; ++row) {
    for (std::uint64_t column = 0; column < row; ++column, ++i) {
      if (!check.require_finite("number", i, factor[i])) return false;
    }
    if (!check.require_above("number", i, factor[i], 0)) return false;
    ++i;
  }
  return true;
}

}  // namespace greenloop::multigrid
