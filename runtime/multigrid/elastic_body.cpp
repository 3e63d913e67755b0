#include "runtime/multigrid/elastic_body.hpp"

#include <cstddef>

namespace greenloop {
namespace {

constexpr std::uint32_t lanes = 4;

std::uint32_t groups_of(const MultigridView& view) { return (view.info->tetrahedra + lanes - 1) / lanes; }

template <class T>
std::span<T> take(Arena& arena, std::size_t count) {
  return {arena.take_zeroed<T>(count), count};
}

ElasticState take_state(Arena& arena, std::size_t vertices) {
  ElasticState state;
  state.displacement = take<Float4>(arena, vertices);
  state.velocity = take<Float4>(arena, vertices);
  state.acceleration = take<Float4>(arena, vertices);
  return state;
}

MultigridLevel level_of(const GridView& grid) {
  const std::size_t n = grid.vertices;
  return {{grid.row_starts, n + 1},
          {grid.row_uppers, n},
          grid.columns,
          {reinterpret_cast<const Block<3>*>(grid.blocks), grid.columns.size()},
          {reinterpret_cast<const Block<3>*>(grid.inverses), n},
          {grid.parent_starts, n + 1},
          grid.parents,
          {grid.weights, grid.parents.size()}};
}

Float4 point(const MultigridView& view, std::uint32_t vertex) {
  const float* const at = view.points + std::size_t{3} * vertex;
  return Float4{at[0], at[1], at[2], 0.0F};
}

Float4 cross(Float4 a, Float4 b) {
  return Float4{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0.0F};
}

void set_element(const MultigridView& view, const layout::TetrahedronRecord& record, std::size_t lane,
                 TetrahedronGroup& group) {
  const Float4 first = point(view, record.vertex[0]);
  const Float4 a = point(view, record.vertex[1]) - first, b = point(view, record.vertex[2]) - first,
               c = point(view, record.vertex[3]) - first;
  const Float4 normal[3] = {cross(b, c), cross(c, a), cross(a, b)};
  const float six_volumes = a[0] * normal[0][0] + a[1] * normal[0][1] + a[2] * normal[0][2];
  const layout::MatterRecord& matter = view.matters[record.matter];
  const float volume = six_volumes / 6;
  for (std::size_t corner = 0; corner < 4; ++corner) group.vertex[corner][lane] = record.vertex[corner];
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      group.gradient[corner][axis][lane] = normal[corner][axis] / six_volumes;
    }
  }
  group.lambda[lane] = matter.lambda * volume;
  group.mu[lane] = matter.mu * volume;
  group.mass[lane] = matter.density * volume;
  group.volume[lane] = volume;
}

}  // namespace

ElasticBody* place_elastic_body(Arena& arena, const MultigridView& view, std::uint32_t max_holds) noexcept {
  ElasticBody* const body = arena.take_zeroed<ElasticBody>(1);
  ElasticBody counted;
  ElasticBody& placed = body == nullptr ? counted : *body;
  placed = {};
  placed.view = view;
  placed.max_holds = max_holds;
  const layout::MultigridInfo& info = *view.info;
  placed.groups = take<TetrahedronGroup>(arena, groups_of(view));
  placed.frame = take<Matrix4>(arena, placed.groups.size());
  placed.quaternion = take<Quaternion4>(arena, placed.groups.size());
  placed.last_quaternion = take<Quaternion4>(arena, placed.groups.size());
  placed.vertex_quaternion = take<Float4>(arena, info.free);
  placed.turned = take<Float4>(arena, info.free);
  placed.state = take_state(arena, info.vertices);
  placed.next = take_state(arena, info.vertices);
  for (std::span<Float4>* const field : {&placed.force, &placed.residual, &placed.inertia, &placed.rest,
                                         &placed.preconditioned, &placed.direction, &placed.image, &placed.change}) {
    *field = take<Float4>(arena, info.vertices);
  }
  placed.vertex_mass = take<float>(arena, info.vertices);
  placed.moves = take<float>(arena, info.vertices);
  placed.held = take<std::uint32_t>(arena, max_holds);
  for (std::uint32_t g = 0; g < info.grids; ++g) {
    const std::size_t vertices = g + 1 < info.grids ? view.grid[g].vertices : info.coarsest_vertices;
    placed.fields[g].b = take<Float4>(arena, vertices);
    placed.fields[g].x = take<Float4>(arena, vertices);
  }
  placed.cycle.scratch = take<double>(arena, std::size_t{3} * info.coarsest_vertices);
  return body;
}

void begin_elastic_body(ElasticBody& body) noexcept {
  const MultigridView& view = body.view;
  const layout::MultigridInfo& info = *view.info;
  body.measure = static_cast<StrainMeasure>(info.strain);
  body.newmark =
      Newmark(static_cast<float>(info.time_step), info.numerical_damping, info.mass_damping, info.stiffness_damping);
  for (std::size_t t = 0; t < view.tetrahedra.size(); ++t) {
    TetrahedronGroup& group = body.groups[t / lanes];
    set_element(view, view.tetrahedra[t], t % lanes, group);
    for (const std::uint32_t v : view.tetrahedra[t].vertex) body.vertex_mass[v] += 0.25F * group.mass[t % lanes];
  }
  const Float4 none{}, one = splat(1.0F);
  for (Quaternion4& quaternion : body.quaternion) quaternion = {none, none, none, one};
  for (Matrix4& frame : body.frame) frame = {{{one, none, none}, {none, one, none}, {none, none, one}}};
  for (Float4& quaternion : body.vertex_quaternion) quaternion = Float4{0, 0, 0, 1};
  for (std::uint32_t v = 0; v < info.free; ++v) body.moves[v] = 1;
  for (std::uint32_t g = 0; g + 1 < info.grids; ++g) body.levels[g] = level_of(view.grid[g]);
  body.cycle.levels = {body.levels, info.grids - 1};
  body.cycle.coarsest = {info.coarsest_vertices, view.coarsest_factor};
  body.cycle.fields = {body.fields, info.grids};
}

namespace {

// what pieces take, in instructions
/// Of four tetrahedra, by the measure of strain: their frames, forces and turns, and the frames that a step keeps, to
/// go back to.
struct GroupUnits {
  std::uint64_t frame, force, turn, kept;
};
constexpr GroupUnits group_units[] = {{0, 1080, 0, 0}, {880, 1200, 460, 80}, {255, 1180, 460, 255}};
constexpr std::uint64_t product_units = 750, stress_units = 560;
constexpr std::uint64_t moved_vertex_units = 60, met_vertex_units = 95, turned_vertex_units = 95,
                        stepped_vertex_units = 110;
constexpr std::uint64_t shown_units = 32, read_vertex_units = 12, input_units = 40;
constexpr std::uint64_t block_units = 24, row_units = 50, parent_units = 16;
constexpr std::uint64_t step_units = 600, pass_units = 300, iteration_units = 400;

const GroupUnits& units_of(const MultigridView& view) { return group_units[view.info->strain]; }

/// Of a cycle: every block is met twice, every parent twice.
std::uint64_t cycle_work(const MultigridView& view) {
  std::uint64_t work = 0;
  for (std::uint32_t g = 0; g + 1 < view.info->grids; ++g) {
    const GridView& grid = view.grid[g];
    work += 2 * (row_units * grid.vertices + block_units * grid.columns.size() + parent_units * grid.parents.size());
  }
  const std::uint64_t order = 3 * std::uint64_t{view.info->coarsest_vertices};
  return work + 3 * order * order + row_units * order;
}

}  // namespace

std::uint64_t residual_work(const MultigridView& view) noexcept {
  return pass_units + (units_of(view).frame + units_of(view).force) * groups_of(view) +
         moved_vertex_units * view.info->vertices;
}

std::uint64_t pass_work(const MultigridView& view) noexcept {
  return pass_units + units_of(view).turn * groups_of(view) +
         (moved_vertex_units + turned_vertex_units) * view.info->vertices;
}

std::uint64_t product_work(const MultigridView& view) noexcept {
  return product_units * groups_of(view) + met_vertex_units * view.info->vertices;
}

std::uint64_t iteration_work(const MultigridView& view) noexcept {
  return iteration_units + product_work(view) + turned_vertex_units * view.info->vertices + cycle_work(view);
}

std::uint64_t shown_work(const MultigridView& view) noexcept { return shown_units * view.info->shown; }

std::uint64_t stress_work(const MultigridView& view) noexcept {
  return stress_units * groups_of(view) + read_vertex_units * view.info->vertices;
}

std::uint64_t state_work(const MultigridView& view, std::uint32_t loads, std::uint32_t holds) noexcept {
  return step_units + units_of(view).kept * groups_of(view) + stepped_vertex_units * view.info->vertices +
         input_units * (std::uint64_t{loads} + std::uint64_t{2} * holds);
}

}  // namespace greenloop
