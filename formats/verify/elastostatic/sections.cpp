#include "formats/verify/elastostatic/sections.hpp"

#include <algorithm>
#include <array>

namespace greenloop::elastostatic {
namespace {

using layout::NodeRecord;
using layout::RefinementRecord;
using layout::StencilRecord;

constexpr std::uint32_t known_flags =
    layout::node_domain | layout::node_touchable | layout::node_fixed | layout::node_read;

bool has_flag(const NodeRecord& node, layout::NodeFlag flag) { return (node.flags & flag) != 0; }

// the node of a file index below view.node_count
const NodeRecord& node_at(const ElastostaticView& view, std::uint32_t index) {
  std::uint32_t q = 0;
  while (index - view.level[q].node_begin >= view.level[q].counts->node_count) ++q;
  return view.level[q].nodes[index - view.level[q].node_begin];
}

// of the material; a scalar problem has none
bool verify_material(SectionCheck& check, const layout::Info& info) {
  if (static_cast<layout::Problem>(info.problem) == layout::Problem::scalar) {
    return check.require_equal("young", 0, info.young, 0) && check.require_equal("poisson", 0, info.poisson, 0);
  }
  return check.require_above("young", 0, info.young, 0) && check.require_above("poisson", 0, info.poisson, -1) &&
         check.require(info.poisson < 0.5, VerifyRule::out_of_range, "poisson", 0, info.poisson, 0.5);
}

bool verify_quanta(SectionCheck& check, const layout::Info& info) {
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    if (!check.require_at_least("quantum", layer, info.quantum[layer], 0) ||
        !check.require_at_most("quantum", layer, info.quantum[layer], 1)) {
      return false;
    }
  }
  return true;
}

// only elastostatic models have loads
bool verify_load_count(SectionCheck& check, const layout::Info& info) {
  return check.require_at_most("loads", 0, info.loads, info.components == 3 ? layout::most_loads : 0);
}

bool verify_box(SectionCheck& check, const layout::Info& info) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (!check.require_finite("box_min", k, info.box_min[k]) ||
        !check.require_at_least("box_max", k, info.box_max[k], info.box_min[k])) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool verify_info(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(sizeof(layout::Info))) return false;
  const auto& info = *section.as<layout::Info>();
  const std::uint32_t present = context.levels;
  const std::uint32_t components = layout::components_of(static_cast<layout::Problem>(info.problem));
  context.view.info = &info;
  return check.require_enum("wavelet", info.wavelet, static_cast<std::uint32_t>(layout::Wavelet::equilibrated)) &&
         check.require_equal("components", 0, info.components, components) &&
         check.require_at_most("levels", 0, info.levels, layout::max_levels) &&
         check.require(info.levels >= present, VerifyRule::inconsistent, "levels", 0, info.levels, present) &&
         verify_material(check, info) && check.require_at_least("threshold", 0, info.threshold, 0) &&
         check.require_at_least("store_asymmetry", 0, info.store_asymmetry, 0) &&
         check.require_at_least("lambda_min", 0, info.lambda_min, 0) && verify_box(check, info) &&
         check.require_above("rate", 0, info.rate, 0) && check.require_at_least("share", 0, info.share, 0) &&
         check.require_at_most("share", 0, info.share, 1) &&
         check.require_at_least("max_contacts", 0, info.max_contacts, 1) &&
         check.require_at_most("max_contacts", 0, info.max_contacts, layout::most_contacts) &&
         check.require_at_most("coarsest_constraint_level", 0, info.coarsest_constraint_level, present - 1) &&
         check.require_equal("finest_constraint_level", 0, info.finest_constraint_level, info.levels - 1) &&
         verify_quanta(check, info) && verify_load_count(check, info) &&
         check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(info.reserved))),
                       VerifyRule::reserved_not_zero, "reserved", 0, 1, 0);
}

namespace {

bool verify_level_counts(SectionCheck& check, const layout::Level& counts, const Section& section,
                         const ElastostaticView& view) {
  const std::uint64_t nodes = std::uint64_t{view.node_count} + counts.node_count;
  const std::uint64_t domain = std::uint64_t{view.domain_count} + counts.domain_count;
  const bool constrained = section.a >= view.info->coarsest_constraint_level;
  return check.require_at_least("node_count", 0, counts.node_count, 1) &&
         check.require(nodes < layout::none, VerifyRule::out_of_range, "node_count", 0, static_cast<double>(nodes),
                       layout::none - 1.0) &&
         check.require_at_most("domain_count", 0, counts.domain_count, counts.node_count) &&
         check.require(domain > 0 || !constrained, VerifyRule::inconsistent, "domain_count", 0, counts.domain_count,
                       1) &&
         check.require((counts.base_triangle_count > 0) == (section.a == 0), VerifyRule::inconsistent,
                       "base_triangle_count", 0, counts.base_triangle_count, section.a == 0 ? 1 : 0) &&
         check.require(counts.dense_blocks == domain * domain, VerifyRule::inconsistent, "dense_blocks", 0,
                       static_cast<double>(counts.dense_blocks), static_cast<double>(domain * domain));
}

bool verify_level_errors(SectionCheck& check, const layout::Level& counts) {
  return check.require_at_least("cut_error", 0, counts.cut_error, 0) &&
         check.require_at_least("rms_error", 0, counts.rms_error, 0) &&
         check.require_at_least("worst_column_error", 0, counts.worst_column_error, 0) &&
         check.require_at_least("patch_force_error", 0, counts.patch_force_error, 0) &&
         check.require_at_least("field_rms_error", 0, counts.field_rms_error, 0) &&
         check.require_at_least("field_column_error", 0, counts.field_column_error, 0) &&
         check.require_at_least("field_error", 0, counts.field_error, 0) &&
         check.require_at_least("field_peak", 0, counts.field_peak, 0) &&
         check.require_at_least("force_error", 0, counts.force_error, 0);
}

}  // namespace

std::uint32_t domain_of_mesh(const ElastostaticView& view, std::uint32_t q) {
  return view.level[q].domain_begin + view.level[q].counts->domain_count;
}

bool verify_index_bytes(SectionCheck& check, std::uint32_t index_bytes, std::uint32_t rows) {
  return check.require(index_bytes == 2 || index_bytes == 4, VerifyRule::bad_enum, "index_bytes", 0, index_bytes, 4) &&
         check.require(index_bytes != 2 || rows <= 65536, VerifyRule::inconsistent, "index_bytes", 0, 2, 4);
}

bool verify_level(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(sizeof(layout::Level))) return false;
  const auto& counts = *section.as<layout::Level>();
  if (!verify_level_counts(check, counts, section, context.view) || !verify_level_errors(check, counts)) return false;
  LevelView& level = context.view.level[section.a];
  level.counts = &counts;
  level.node_begin = context.view.node_count;
  level.domain_begin = context.view.domain_count;
  context.view.node_count += counts.node_count;
  context.view.domain_count += counts.domain_count;
  context.view.levels = section.a + 1u;
  return true;
}

namespace {

bool verify_node(SectionCheck& check, const layout::Info& info, const NodeRecord& node, std::uint32_t i,
                 bool in_domain) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (!check.require_at_least("position", i, node.position[k], info.box_min[k]) ||
        !check.require_at_most("position", i, node.position[k], info.box_max[k])) {
      return false;
    }
  }
  const std::uint32_t flags = node.flags;
  const bool fixed = has_flag(node, layout::node_fixed);
  return check.require_at_least("area", i, node.area, 0) &&
         check.require((flags & ~known_flags) == 0, VerifyRule::bad_enum, "flags", i, flags, known_flags) &&
         check.require(has_flag(node, layout::node_domain) == in_domain, VerifyRule::inconsistent, "flags.domain", i,
                       flags, in_domain ? 1 : 0) &&
         check.require(!(in_domain && fixed), VerifyRule::inconsistent, "flags.fixed", i, flags, 0) &&
         check.require(in_domain || !has_flag(node, layout::node_touchable), VerifyRule::inconsistent,
                       "flags.touchable", i, flags, 0) &&
         check.require(in_domain || fixed || !has_flag(node, layout::node_read), VerifyRule::inconsistent, "flags.read",
                       i, flags, 0);
}

}  // namespace

bool verify_nodes(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  LevelView& level = context.view.level[section.a];
  const auto* nodes = section.as<NodeRecord>();
  if (!check.require_count(level.counts->node_count)) return false;
  for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
    if (!verify_node(check, *context.view.info, nodes[i], i, i < level.counts->domain_count)) return false;
  }
  level.nodes = nodes;
  return true;
}

bool verify_base_triangles(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const layout::Level& counts = *context.view.level[0].counts;
  const auto* corners = section.as<std::uint32_t>();
  if (!check.require_count(counts.base_triangle_count)) return false;
  for (std::uint64_t t = 0; t < counts.base_triangle_count; ++t) {
    const std::uint32_t* corner = corners + 3 * t;
    for (std::uint64_t k = 0; k < 3; ++k) {
      if (!check.require_at_most("corner", 3 * t + k, corner[k], counts.node_count - 1.0) ||
          !check.require(corner[k] != corner[(k + 1) % 3], VerifyRule::inconsistent, "corner", 3 * t + k, corner[k],
                         corner[(k + 1) % 3])) {
        return false;
      }
    }
  }
  context.view.base_triangles = corners;
  return true;
}

namespace {

bool verify_parent(SectionCheck& check, const ElastostaticView& view, const RefinementRecord& record, std::uint32_t i,
                   std::uint32_t k, std::uint32_t first_of_level, bool in_domain) {
  if (!check.require_at_most("parent", i, record.parent[k], first_of_level - 1.0) ||
      !check.require_finite("lift", i, record.lift[k])) {
    return false;
  }
  const NodeRecord& parent = node_at(view, record.parent[k]);
  const bool parent_in_domain = has_flag(parent, layout::node_domain);
  const bool lifted = layout::is_lifted(static_cast<layout::Wavelet>(view.info->wavelet));
  return check.require((lifted && parent_in_domain) || record.lift[k] == 0, VerifyRule::inconsistent, "lift", i,
                       record.lift[k], 0) &&
         check.require(!in_domain || parent_in_domain || has_flag(parent, layout::node_fixed), VerifyRule::inconsistent,
                       "parent", i, record.parent[k], layout::none);
}

}  // namespace

bool verify_refinement(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  LevelView& level = context.view.level[section.a];
  const auto* records = section.as<RefinementRecord>();
  if (!check.require_count(level.counts->node_count)) return false;
  for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
    const bool in_domain = i < level.counts->domain_count;
    for (std::uint32_t k = 0; k < 2; ++k) {
      if (!verify_parent(check, context.view, records[i], i, k, level.node_begin, in_domain)) return false;
    }
    if (!check.require(records[i].parent[0] != records[i].parent[1], VerifyRule::inconsistent, "parent", i,
                       records[i].parent[1], records[i].parent[0])) {
      return false;
    }
  }
  level.refinement = records;
  return true;
}

namespace {

// the six nodes of a stencil, in file order
std::array<std::uint32_t, 6> nodes_of(const StencilRecord& stencil) {
  return {stencil.wing[0], stencil.wing[1], stencil.outer[0], stencil.outer[1], stencil.outer[2], stencil.outer[3]};
}

bool verify_stencil(SectionCheck& check, const ElastostaticView& view, const StencilRecord& stencil, std::uint32_t i,
                    std::uint32_t first_of_level) {
  const auto nodes = nodes_of(stencil);
  const bool absent = nodes[0] == layout::none;
  for (const std::uint32_t node : nodes) {
    if (absent && !check.require_equal("node", i, node, layout::none)) return false;
    if (absent) continue;
    if (!check.require_at_most("node", i, node, first_of_level - 1.0)) return false;
    const NodeRecord& record = node_at(view, node);
    const bool known = has_flag(record, layout::node_domain) || has_flag(record, layout::node_fixed);
    if (!check.require(known, VerifyRule::inconsistent, "node", i, node, layout::none)) return false;
  }
  return true;
}

}  // namespace

bool verify_stencils(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  LevelView& level = context.view.level[section.a];
  const auto* stencils = section.as<StencilRecord>();
  if (!check.require_count(level.counts->domain_count)) return false;
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    if (!verify_stencil(check, context.view, stencils[i], i, level.node_begin)) return false;
  }
  level.stencils = stencils;
  return true;
}

namespace {

// who stands on constraint level c for node i of level q
bool verify_representative(SectionCheck& check, const ElastostaticView& view, std::uint32_t c, std::uint32_t q,
                           std::uint32_t i, std::uint32_t representative) {
  const NodeRecord& node = view.level[q].nodes[i];
  if (!has_flag(node, layout::node_touchable)) {
    return check.require_equal("node", i, representative, layout::none);
  }
  // a node of K(c) stands for itself
  if (q <= c) return check.require_equal("node", i, representative, view.level[q].node_begin + i);
  const std::uint32_t end = view.level[c].node_begin + view.level[c].counts->node_count;
  return check.require_at_most("node", i, representative, end - 1.0) &&
         check.require(has_flag(node_at(view, representative), layout::node_domain), VerifyRule::inconsistent, "node",
                       i, representative, layout::none);
}

}  // namespace

bool verify_representatives(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t node_count = context.view.level[section.b].counts->node_count;
  const auto* representatives = section.as<std::uint32_t>();
  if (!check.require_count(node_count)) return false;
  for (std::uint32_t i = 0; i < node_count; ++i) {
    if (!verify_representative(check, context.view, section.a, section.b, i, representatives[i])) return false;
  }
  context.view.representatives[section.a][section.b] = representatives;
  return true;
}

namespace {

bool verify_positive_definite(SectionCheck& check, const char* field, const float (&one)[1], std::uint32_t i) {
  return check.require_above(field, i, one[0], 0);
}

// Sylvester's criterion; the products of floats are exact or nearly so in double
bool verify_positive_definite(SectionCheck& check, const char* field, const float (&six)[6], std::uint32_t i) {
  for (const float value : six) {
    if (!check.require_finite(field, i, value)) return false;
  }
  const double xx = six[0], xy = six[1], xz = six[2];
  const double yy = six[3], yz = six[4], zz = six[5];
  const double minors[] = {
      xx, xx * yy - xy * xy,
      xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)};  // of 1, 2 and 3 rows
  for (const double minor : minors) {
    if (!check.require(minor > 0, VerifyRule::out_of_range, field, i, minor, 0)) return false;
  }
  return true;
}

template <unsigned N>
bool verify_scales_of(const Section& section, std::uint32_t count, SectionCheck& check) {
  const auto* scales = section.as<layout::Scale<N>>();
  if (!check.require_count(std::uint64_t{count} * (sizeof *scales / sizeof(float)))) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!verify_positive_definite(check, "root", scales[i].root, i) ||
        !verify_positive_definite(check, "diagonal", scales[i].diagonal, i)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool verify_scales(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  LevelView& level = context.view.level[section.a];
  const std::uint32_t count = level.counts->domain_count;
  if (!(context.view.info->components == 1 ? verify_scales_of<1>(section, count, check)
                                           : verify_scales_of<3>(section, count, check))) {
    return false;
  }
  level.scales = section.data;
  context.kept_blocks += count;
  return true;
}

bool verify_counts(std::uint32_t q, VerifyContext& context) {
  const layout::Level& counts = *context.view.level[q].counts;
  const Section section{layout::SectionKind::level, static_cast<std::uint16_t>(q), 0, nullptr, 0};
  SectionCheck check(section, context.result);
  return check.require(counts.kept_blocks == context.kept_blocks, VerifyRule::inconsistent, "kept_blocks", 0,
                       static_cast<double>(counts.kept_blocks), static_cast<double>(context.kept_blocks));
}

}  // namespace greenloop::elastostatic
