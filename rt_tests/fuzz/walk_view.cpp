#include "rt_tests/fuzz/walk_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>

#include "formats/testing/reseal.hpp"
#include "formats/verify.hpp"
#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

class Walk {
 public:
  Walk(std::span<const std::byte> file, const ModelView& view) : file_(file), view_(view) {}

  bool whole_view() {
    if (view_.problem == layout::Problem::multigrid) return multigrid_view();
    return view_.problem == layout::Problem::impulse_response ? impulse_view() : elastostatic_view();
  }

 private:
  bool elastostatic_view() {
    if (!array(view_.header, 1) || !array(view_.info, 1) || components() != layout::components_of(view_.problem) ||
        !array(view_.base_triangles, triangle_corners()) || !array(view_.provenance.data(), view_.provenance.size())) {
      return false;
    }
    if (!all(view_.base_triangles, triangle_corners(), [&](auto corner) { return corner < count(0); })) return false;
    for (std::uint32_t q = 0; q < view_.levels; ++q) {
      if (!level(q)) return false;
    }
    for (std::uint32_t c = 0; c < view_.levels; ++c) {
      for (std::uint32_t q = 0; q < view_.levels; ++q) {
        if (!representatives(c, q)) return false;
      }
    }
    return vertices() && loads() && ready();
  }

  // every number of every array is read; indices stay inside
  bool impulse_view() const {
    const ImpulseResponseView& view = view_.impulse_response;
    if (!array(view_.header, 1) || !array(view_.provenance.data(), view_.provenance.size()) || !array(view.info, 1)) {
      return false;
    }
    const layout::ImpulseInfo& info = *view.info;
    const std::uint64_t references = std::uint64_t{info.rows} * info.impulses;
    const std::uint64_t successions = std::uint64_t{info.impulses + 1} * info.impulses;
    if (!array(view.shape, std::uint64_t{3} * info.vertices) || !array(view.quanta, view.blocks()) ||
        !array(view.triangles, std::uint64_t{3} * info.triangles) || !array(view.orbits.data(), info.orbits) ||
        !array(view.impulses.data(), info.impulses) || !array(view.successions, successions) ||
        !array(view.references, references)) {
      return false;
    }
    const auto is_finite = [](float x) { return std::isfinite(x); };
    const auto leads_on = [&](const layout::OrbitRecord& orbit) {
      const bool inside = std::uint64_t{orbit.first_row} + orbit.rows <= info.rows && orbit.rows >= 2;
      return inside && (orbit.next_orbit == layout::none ||
                        (orbit.next_orbit < info.orbits && orbit.next_row > 0 && orbit.next_row + 1 < info.rows));
    };
    return all(view.shape, std::uint64_t{3} * info.vertices, is_finite) && all(view.quanta, view.blocks(), is_finite) &&
           all(view.triangles, std::uint64_t{3} * info.triangles, [&](auto v) { return v < info.vertices; }) &&
           all(view.orbits.data(), info.orbits, leads_on) &&
           all(view.successions, successions, [](auto flag) { return flag <= 1; }) &&
           all(view.references, references,
               [&](const auto& reference) {
                 return reference.orbit == layout::none || reference.orbit < info.orbits;
               }) &&
           impulse_groups(view) && appearance(view);
  }

  bool multigrid_view() const {
    const MultigridView& view = view_.multigrid;
    if (!array(view_.header, 1) || !array(view_.provenance.data(), view_.provenance.size()) || !array(view.info, 1)) {
      return false;
    }
    const layout::MultigridInfo& info = *view.info;
    const auto is_finite = [](auto x) { return std::isfinite(x); };
    const auto of_body = [&](const layout::TetrahedronRecord& record) {
      return std::all_of(std::begin(record.vertex), std::end(record.vertex),
                         [&](auto v) { return v < info.vertices; }) &&
             record.matter < info.matters;
    };
    const auto bound = [&](const layout::BindingRecord& binding) {
      return std::all_of(std::begin(binding.vertex), std::end(binding.vertex),
                         [&](auto v) { return v < info.vertices; });
    };
    const std::uint64_t order = std::uint64_t{3} * info.coarsest_vertices;
    return array(view.points, std::uint64_t{3} * info.vertices) && array(view.tetrahedra.data(), info.tetrahedra) &&
           array(view.matters, info.matters) && array(view.shape, std::uint64_t{3} * info.shown) &&
           array(view.triangles, std::uint64_t{3} * info.triangles) && array(view.bindings.data(), info.shown) &&
           array(view.coarsest_factor.data(), order * (order + 1) / 2) &&
           all(view.points, std::uint64_t{3} * info.vertices, is_finite) &&
           all(view.tetrahedra.data(), info.tetrahedra, of_body) &&
           all(view.triangles, std::uint64_t{3} * info.triangles, [&](auto v) { return v < info.shown; }) &&
           all(view.bindings.data(), info.shown, bound) &&
           all(view.coarsest_factor.data(), order * (order + 1) / 2, is_finite) && grids(view);
  }

  bool grids(const MultigridView& view) const {
    std::uint32_t vertices = view.info->free;
    for (std::uint32_t g = 0; g + 1 < view.info->grids; ++g) {
      const GridView& grid = view.grid[g];
      const std::uint32_t coarser = g + 2 < view.info->grids ? view.grid[g + 1].vertices : view.info->coarsest_vertices;
      const std::uint64_t blocks = grid.columns.size(), parents = grid.parents.size();
      const auto in = [](std::uint64_t end) { return [end](std::uint32_t i) { return i <= end; }; };
      if (grid.vertices != vertices || !array(grid.row_starts, std::uint64_t{vertices} + 1) ||
          !array(grid.row_uppers, vertices) || !array(grid.columns.data(), blocks) ||
          !array(grid.blocks, 12 * blocks) || !array(grid.inverses, std::uint64_t{12} * vertices) ||
          !array(grid.parents.data(), parents) || !array(grid.parent_starts, std::uint64_t{vertices} + 1) ||
          !array(grid.weights, parents) || !all(grid.row_starts, std::uint64_t{vertices} + 1, in(blocks)) ||
          !all(grid.row_uppers, vertices, in(blocks)) ||
          !all(grid.parent_starts, std::uint64_t{vertices} + 1, in(parents)) ||
          !all(grid.columns.data(), blocks, [&](auto v) { return v < vertices; }) ||
          !all(grid.parents.data(), parents, [&](auto v) { return v < coarser; }) ||
          !all(grid.blocks, 12 * blocks, [](float x) { return std::isfinite(x); }) ||
          !all(grid.inverses, std::uint64_t{12} * vertices, [](float x) { return std::isfinite(x); })) {
        return false;
      }
      vertices = coarser;
    }
    return vertices == view.info->coarsest_vertices;
  }

  bool appearance(const ImpulseResponseView& view) const {
    const AppearanceView& of = view.appearance;
    if (of.modes == 0) return true;
    const auto any = [](const auto&) { return true; };
    const auto rows = std::uint64_t{view.info->rows} * of.modes, blocks = std::uint64_t{view.blocks()};
    const std::uint64_t bytes = blocks * layout::colours * layout::transfer_bytes(of.modes);
    return of.modes <= layout::most_transfer_modes && array(of.quanta, 2 * blocks) && array(of.transfers, bytes) &&
           array(of.amplitudes, of.modes) && array(of.coordinates, rows) &&
           all(of.quanta, 2 * blocks, [](float x) { return std::isfinite(x); }) && all(of.transfers, bytes, any) &&
           all(of.coordinates, rows, [](auto x) { return x >= -layout::most_coordinate; });
  }

  bool impulse_groups(const ImpulseResponseView& view) const {
    std::uint32_t modes = 0;
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      const ModeGroupView& group = view.group[q];
      const std::uint64_t of_group = group.counts->modes;
      modes += group.counts->modes;
      for (std::uint32_t plane = 0; plane < view.info->planes; ++plane) {
        const std::uint64_t values = std::uint64_t{view.blocks()} * layout::block_values * of_group;
        if (!array(group.plane[plane], values) || !all(group.plane[plane], values, [](auto) { return true; }))
          return false;
      }
      const std::uint64_t coordinates = view.info->rows * of_group;
      if (!array(group.amplitudes, of_group) || !array(group.coordinates, coordinates) ||
          !all(group.coordinates, coordinates, [](auto x) { return x >= -layout::most_coordinate; })) {
        return false;
      }
    }
    return modes == view.modes;
  }

  [[nodiscard]] std::uint32_t count(std::uint32_t q) const { return view_.level[q].counts->node_count; }
  [[nodiscard]] std::uint32_t domain(std::uint32_t q) const { return view_.level[q].counts->domain_count; }
  [[nodiscard]] std::uint32_t domain_of_mesh(std::uint32_t q) const { return view_.level[q].domain_begin + domain(q); }
  [[nodiscard]] std::uint32_t components() const { return view_.info->components; }
  [[nodiscard]] std::size_t triangle_corners() const {
    return std::size_t{3} * view_.level[0].counts->base_triangle_count;
  }

  template <class Record>
  bool array(const Record* records, std::uint64_t count) const {
    if (count == 0) return true;
    const auto begin = reinterpret_cast<std::uintptr_t>(records), file = reinterpret_cast<std::uintptr_t>(file_.data());
    return begin >= file && begin % alignof(Record) == 0 && begin - file <= file_.size() &&
           count <= (file_.size() - (begin - file)) / sizeof(Record);
  }

  template <class Record, class Right>
  static bool all(const Record* records, std::uint64_t count, Right right) {
    return std::all_of(records, records + count, right);
  }

  bool level(std::uint32_t q) const {
    const LevelView& level = view_.level[q];
    if (!array(level.counts, 1) || !array(level.nodes, count(q)) || (q > 0 && !array(level.refinement, count(q)))) {
      return false;
    }
    const auto coarser = [&](const layout::RefinementRecord& record) {
      return record.parent[0] < level.node_begin && record.parent[1] < level.node_begin;
    };
    const auto known = [&](const layout::StencilRecord& stencil) {
      const auto right = [&](std::uint32_t node) {
        return (node == layout::none) == (stencil.wing[0] == layout::none) &&
               (node == layout::none || node < level.node_begin);
      };
      return std::all_of(stencil.wing, stencil.wing + 2, right) && std::all_of(stencil.outer, stencil.outer + 4, right);
    };
    const std::uint32_t stencils = level.stencils == nullptr ? 0 : level.counts->domain_count;
    if (!array(level.stencils, stencils) || !all(level.stencils, stencils, known)) return false;
    return all(level.nodes, count(q), [](const auto& node) { return std::isfinite(node.position[2] + node.area); }) &&
           (q == 0 || all(level.refinement, count(q), coarser)) && predictions(q) &&
           (components() == 1 ? scales<1>(q) : scales<3>(q)) && all_couplings(q) && patterns(q) && load_columns(q);
  }

  bool predictions(std::uint32_t q) const {
    const PredictionsView& view = view_.level[q].predictions;
    const std::uint64_t terms = std::uint64_t{domain(q)} * view.terms;
    if (view.terms == 0) return true;
    const auto coarser = [&](std::uint32_t place) { return place < view_.level[q].domain_begin; };
    const auto* two = static_cast<const std::uint16_t*>(view.index);
    const auto* four = static_cast<const std::uint32_t*>(view.index);
    const bool known = view.index_bytes == 2 ? array(two, terms) && all(two, terms, coarser)
                                             : array(four, terms) && all(four, terms, coarser);
    return known && view.terms <= layout::most_prediction_terms &&
           values(reinterpret_cast<const std::int16_t*>(view.weight), terms);
  }

  bool patterns(std::uint32_t q) const {
    const auto& patterns = view_.level[q].patterns;
    const auto right = [](const layout::PatternRecord& record) {
      return record.kind >= 1 && record.kind <= layout::pattern_kinds && record.samples > 0 &&
             std::isfinite(record.field_error[2] + record.field_peak[0] + record.total_force_error[1]);
    };
    return array(patterns.data(), patterns.size()) && all(patterns.data(), patterns.size(), right);
  }

  bool loads() const {
    const auto right = [](const layout::LoadRecord& load) {
      return load.kind >= 1 && load.kind <= layout::load_kinds && std::isfinite(load.resultant[2]) &&
             *std::prev(std::end(load.name)) == 0;
    };
    return view_.loads.size() == view_.info->loads && (!view_.has_gravity() || view_.loads.size() >= 3) &&
           array(view_.loads.data(), view_.loads.size()) && all(view_.loads.data(), view_.loads.size(), right);
  }

  bool load_columns(std::uint32_t q) const {
    const std::uint64_t numbers = std::uint64_t{3} * view_.info->loads * domain(q);
    return array(view_.level[q].load_columns, numbers) &&
           all(view_.level[q].load_columns, numbers, [](float number) { return std::isfinite(number); });
  }

  bool vertices() const {
    const auto right = [&](const layout::VertexRecord& record) {
      return std::all_of(record.node, record.node + 3, [&](std::uint32_t node) { return node < view_.node_count; }) &&
             std::isfinite(record.weight[0] + record.weight[1] + record.weight[2]);
    };
    return array(view_.vertices.data(), view_.vertices.size()) &&
           all(view_.vertices.data(), view_.vertices.size(), right);
  }

  bool ready() const {
    const ReadyTables& ready = view_.ready;
    if (ready.read == nullptr) return true;
    const BaseColumns& base = ready.base;
    const std::uint64_t tile = std::uint64_t{BaseColumns::width} * components() * components();
    if (!array(ready.read, view_.domain_count) || !array(base.value, tile * base.tiles * base.columns) ||
        (base.columns != 0 && (base.columns != domain(0) || base.tiles != (view_.domain_count + 7) / 8))) {
      return false;
    }
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& mirrored = ready.mirrored.layer[layer];
      if ((mirrored.columns != 0 && mirrored.columns != view_.domain_count) || mirrored.rows != view_.domain_count ||
          !sound(mirrored, layout::value_bits[layer], true)) {
        return false;
      }
    }
    return true;
  }

  template <unsigned N>
  bool scales(std::uint32_t q) const {
    const layout::Scale<N>* const scales = view_.level[q].scales_of<N>();
    const auto right = [](const layout::Scale<N>& scale) {
      return scale.root[0] > 0 && scale.diagonal[0] > 0 &&
             std::isfinite(*std::prev(std::end(scale.root)) + *std::prev(std::end(scale.diagonal)));
    };
    return array(scales, domain(q)) && all(scales, domain(q), right);
  }

  bool representatives(std::uint32_t c, std::uint32_t q) const {
    const std::uint32_t* node_of = view_.representatives[c][q];
    if (c < view_.info->coarsest_constraint_level) return node_of == nullptr;
    const std::uint32_t end = view_.level[c].node_begin + count(c);
    return array(node_of, count(q)) &&
           all(node_of, count(q), [&](std::uint32_t node) { return node < end || node == layout::none; });
  }

  bool all_couplings(std::uint32_t q) const {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = view_.level[q].couplings[layer];
      const float quantum = view_.info->quantum[layer];
      const bool empty = couplings.columns == 0 && couplings.begin[0] == 0;
      if ((!empty && couplings.columns != domain(q)) || couplings.rows != domain_of_mesh(q) ||
          !(quantum >= 0 && quantum <= 1) || !sound(couplings, layout::value_bits[layer], false)) {
        return false;
      }
    }
    return true;
  }

  bool sound(const CouplingsView& couplings, std::uint32_t value_bits, bool mirrored) const {
    if (!array(couplings.begin, couplings.columns + 1ull)) return false;
    const std::uint64_t block_count = couplings.begin[couplings.columns];
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      if (couplings.begin[j] > couplings.begin[j + 1] || couplings.begin[j + 1] > block_count) return false;
    }
    const bool rows_right =
        couplings.index_bytes == 2
            ? rows_right_of(couplings, static_cast<const std::uint16_t*>(couplings.index), block_count, mirrored)
            : rows_right_of(couplings, static_cast<const std::uint32_t*>(couplings.index), block_count, mirrored);
    if (!rows_right) return false;
    switch (value_bits) {
      case 4:
        return nibbles(couplings.value, block_count);
      case 8:
        return values(reinterpret_cast<const std::int8_t*>(couplings.value), block_count);
      default:
        return values(reinterpret_cast<const std::int16_t*>(couplings.value), block_count);
    }
  }

  template <class Index>
  bool rows_right_of(const CouplingsView& couplings, const Index* index, std::uint64_t block_count,
                     bool mirrored) const {
    if (!array(index, block_count)) return false;
    const std::uint32_t first = couplings.rows - couplings.columns;
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      for (std::uint32_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
        const bool right = mirrored ? index[b] > j && index[b] < couplings.rows : index[b] < first + j;
        if (!right || (b > couplings.begin[j] && index[b] <= index[b - 1])) return false;
      }
    }
    return true;
  }

  bool nibbles(const std::byte* value, std::uint64_t block_count) const {
    const auto negatable = [](std::byte pair) {
      return (pair & std::byte{15}) != std::byte{8} && (pair >> 4) != std::byte{8};
    };
    const std::uint64_t bytes = layout::block_bytes(components(), 4) * block_count;
    return array(value, bytes + 16) && all(value, bytes, negatable);
  }

  // a kernel may load 16 bytes beyond the last value
  template <class Value>
  bool values(const Value* value, std::uint64_t block_count) const {
    const std::uint64_t read = std::uint64_t{components()} * components() * block_count + 16 / sizeof(Value);
    return array(value, read) && all(value, read, [](Value v) { return static_cast<Value>(-v) == -v; });
  }

  std::span<const std::byte> file_;
  const ModelView& view_;
};

void require(bool right, const char* what) {
  if (right) return;
  std::fprintf(stderr, "verify: %s\n", what);
  std::abort();
}

VerifyResult verify_and_walk(std::span<const std::byte> file) {
  ModelView view;
  const VerifyResult result = verify(file, view);
  require(result.ok() == (view.header != nullptr), "the view does not agree with the verdict");
  require(!result.ok() || walk_view(file, view), "accepted a file whose view is not sound");
  return result;
}

}  // namespace

bool walk_view(std::span<const std::byte> file, const ModelView& view) { return Walk(file, view).whole_view(); }

InputOutcome try_input(std::span<const std::byte> input) {
  verify_and_walk(AlignedBytes(input).span());

  AlignedBytes mended(input.first(input.size() / layout::alignment * layout::alignment));
  if (mended.size() >= sizeof(layout::Header)) {
    reinterpret_cast<layout::Header*>(mended.data())->file_bytes = mended.size();
    reseal({mended.data(), mended.size()});
  }
  const VerifyResult result = verify_and_walk(mended.span());
  return {result.ok(), static_cast<int>(result.rule)};
}

}  // namespace greenloop
