#include "formats/verify/verify_sections.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace greenloop {
namespace {

using layout::NodeRecord;
using layout::RefinementRecord;
using layout::Scale;
using layout::StencilRecord;

constexpr std::uint32_t known_flags =
    layout::node_domain | layout::node_touchable | layout::node_fixed | layout::node_read;

bool require_size(SectionCheck& check, const Section& section, std::uint64_t count) {
  // a 32-bit count times a small constant: no overflow
  const std::uint64_t expected = count * layout::element_bytes(section.kind);
  return check.require(section.bytes == expected, VerifyRule::section_size, "bytes", 0,
                       static_cast<double>(section.bytes), static_cast<double>(expected));
}

bool require_finite(SectionCheck& check, const char* field, std::uint64_t index, double value) {
  return check.require(std::isfinite(value), VerifyRule::not_finite, field, index, value, 0);
}

bool require_above(SectionCheck& check, const char* field, std::uint64_t index, double value, double limit) {
  return require_finite(check, field, index, value) &&
         check.require(value > limit, VerifyRule::out_of_range, field, index, value, limit);
}

bool require_at_least(SectionCheck& check, const char* field, std::uint64_t index, double value, double limit) {
  return require_finite(check, field, index, value) &&
         check.require(value >= limit, VerifyRule::out_of_range, field, index, value, limit);
}

bool require_at_most(SectionCheck& check, const char* field, std::uint64_t index, double value, double limit) {
  return check.require(value <= limit, VerifyRule::out_of_range, field, index, value, limit);
}

bool require_equal(SectionCheck& check, const char* field, std::uint64_t index, double value, double limit) {
  return check.require(value == limit, VerifyRule::inconsistent, field, index, value, limit);
}

// enumerations whose values are 1 .. last
bool require_enum(SectionCheck& check, const char* field, std::uint32_t value, std::uint32_t last) {
  return check.require(value >= 1 && value <= last, VerifyRule::bad_enum, field, 0, value, last);
}

bool has_flag(const NodeRecord& node, layout::NodeFlag flag) { return (node.flags & flag) != 0; }

// the node of a file index below view.node_count
const NodeRecord& node_at(const ModelView& view, std::uint32_t index) {
  std::uint32_t q = 0;
  while (index - view.level[q].node_begin >= view.level[q].counts->node_count) ++q;
  return view.level[q].nodes[index - view.level[q].node_begin];
}

bool verify_quanta(SectionCheck& check, const layout::Info& info) {
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    if (!require_at_least(check, "quantum", layer, info.quantum[layer], 0) ||
        !require_at_most(check, "quantum", layer, info.quantum[layer], 1)) {
      return false;
    }
  }
  return true;
}

bool verify_box(SectionCheck& check, const layout::Info& info) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (!require_finite(check, "box_min", k, info.box_min[k]) ||
        !require_at_least(check, "box_max", k, info.box_max[k], info.box_min[k])) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool verify_info(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!require_size(check, section, sizeof(layout::Info))) return false;
  const auto& info = *section.as<layout::Info>();
  const std::uint32_t present = context.view.header->levels;
  context.view.info = &info;
  return require_enum(check, "problem", info.problem, static_cast<std::uint32_t>(layout::Problem::elastostatic)) &&
         require_enum(check, "wavelet", info.wavelet, static_cast<std::uint32_t>(layout::Wavelet::equilibrated)) &&
         require_equal(check, "components", 0, info.components, 3) &&
         require_at_most(check, "levels", 0, info.levels, layout::max_levels) &&
         check.require(info.levels >= present, VerifyRule::inconsistent, "levels", 0, info.levels, present) &&
         require_above(check, "young", 0, info.young, 0) && require_above(check, "poisson", 0, info.poisson, -1) &&
         check.require(info.poisson < 0.5, VerifyRule::out_of_range, "poisson", 0, info.poisson, 0.5) &&
         require_at_least(check, "threshold", 0, info.threshold, 0) &&
         require_at_least(check, "store_asymmetry", 0, info.store_asymmetry, 0) &&
         require_at_least(check, "lambda_min", 0, info.lambda_min, 0) && verify_box(check, info) &&
         require_above(check, "rate", 0, info.rate, 0) &&
         require_at_least(check, "max_contacts", 0, info.max_contacts, 1) &&
         require_at_most(check, "coarsest_constraint_level", 0, info.coarsest_constraint_level, present - 1) &&
         require_equal(check, "finest_constraint_level", 0, info.finest_constraint_level, info.levels - 1) &&
         verify_quanta(check, info) &&
         check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(info.reserved))),
                       VerifyRule::reserved_not_zero, "reserved", 0, 1, 0);
}

namespace {

// Bytes of the UTF-8 sequence that `text` starts with; 0 if there is none (Unicode, table 3-7).
std::size_t utf8_length(std::span<const std::byte> text) {
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(text[i]); };
  const std::uint32_t lead = at(0);
  if (lead < 0x80) return lead == 0 ? 0 : 1;
  const std::size_t length = lead >= 0xC2 && lead < 0xE0 ? 2 : lead >= 0xE0 && lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  if (lead < 0xC2 || length == 0 || length > text.size()) return 0;
  const std::uint32_t second_low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const std::uint32_t second_high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (at(1) < second_low || at(1) > second_high) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if (at(i) < 0x80 || at(i) > 0xBF) return 0;
  }
  return length;
}

}  // namespace

bool verify_provenance(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::span text(section.data, static_cast<std::size_t>(section.bytes));
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text.subspan(i));
    if (!check.require(length > 0, VerifyRule::out_of_range, "text", i, std::to_integer<int>(text[i]), 0)) return false;
    i += length;
  }
  context.view.provenance = {section.as<char>(), text.size()};
  return true;
}

namespace {

bool verify_level_counts(SectionCheck& check, const layout::Level& counts, const Section& section,
                         const ModelView& view) {
  const std::uint64_t nodes = std::uint64_t{view.node_count} + counts.node_count;
  const std::uint64_t domain = std::uint64_t{view.domain_count} + counts.domain_count;
  const bool constrained = section.a >= view.info->coarsest_constraint_level;
  return require_at_least(check, "node_count", 0, counts.node_count, 1) &&
         check.require(nodes < layout::none, VerifyRule::out_of_range, "node_count", 0, static_cast<double>(nodes),
                       layout::none - 1.0) &&
         require_at_most(check, "domain_count", 0, counts.domain_count, counts.node_count) &&
         check.require(domain > 0 || !constrained, VerifyRule::inconsistent, "domain_count", 0, counts.domain_count,
                       1) &&
         check.require((counts.base_triangle_count > 0) == (section.a == 0), VerifyRule::inconsistent,
                       "base_triangle_count", 0, counts.base_triangle_count, section.a == 0 ? 1 : 0) &&
         check.require(counts.dense_blocks == domain * domain, VerifyRule::inconsistent, "dense_blocks", 0,
                       static_cast<double>(counts.dense_blocks), static_cast<double>(domain * domain));
}

bool verify_level_errors(SectionCheck& check, const layout::Level& counts) {
  return require_at_least(check, "rms_error", 0, counts.rms_error, 0) &&
         require_at_least(check, "worst_column_error", 0, counts.worst_column_error, 0) &&
         require_at_least(check, "patch_force_error", 0, counts.patch_force_error, 0) &&
         require_at_least(check, "field_rms_error", 0, counts.field_rms_error, 0) &&
         require_at_least(check, "field_column_error", 0, counts.field_column_error, 0) &&
         require_at_least(check, "field_error", 0, counts.field_error, 0) &&
         require_at_least(check, "field_peak", 0, counts.field_peak, 0) &&
         require_at_least(check, "force_error", 0, counts.force_error, 0);
}

}  // namespace

std::uint32_t domain_of_mesh(const ModelView& view, std::uint32_t q) {
  return view.level[q].domain_begin + view.level[q].counts->domain_count;
}

bool verify_level(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!require_size(check, section, sizeof(layout::Level))) return false;
  const auto& counts = *section.as<layout::Level>();
  const bool unused = counts.reserved == 0;
  if (!verify_level_counts(check, counts, section, context.view) || !verify_level_errors(check, counts) ||
      !check.require(!context.reserved_is_zero || unused, VerifyRule::reserved_not_zero, "reserved", 0, 1, 0)) {
    return false;
  }
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
    if (!require_at_least(check, "position", i, node.position[k], info.box_min[k]) ||
        !require_at_most(check, "position", i, node.position[k], info.box_max[k])) {
      return false;
    }
  }
  const std::uint32_t flags = node.flags;
  const bool fixed = has_flag(node, layout::node_fixed);
  return require_at_least(check, "area", i, node.area, 0) &&
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
  if (!require_size(check, section, level.counts->node_count)) return false;
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
  if (!require_size(check, section, counts.base_triangle_count)) return false;
  for (std::uint64_t t = 0; t < counts.base_triangle_count; ++t) {
    const std::uint32_t* corner = corners + 3 * t;
    for (std::uint64_t k = 0; k < 3; ++k) {
      if (!require_at_most(check, "corner", 3 * t + k, corner[k], counts.node_count - 1.0) ||
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

bool verify_parent(SectionCheck& check, const ModelView& view, const RefinementRecord& record, std::uint32_t i,
                   std::uint32_t k, std::uint32_t first_of_level, bool in_domain) {
  if (!require_at_most(check, "parent", i, record.parent[k], first_of_level - 1.0) ||
      !require_finite(check, "lift", i, record.lift[k])) {
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
  if (!require_size(check, section, level.counts->node_count)) return false;
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

bool verify_stencil(SectionCheck& check, const ModelView& view, const StencilRecord& stencil, std::uint32_t i,
                    std::uint32_t first_of_level) {
  const auto nodes = nodes_of(stencil);
  const bool absent = nodes[0] == layout::none;
  for (const std::uint32_t node : nodes) {
    if (absent && !require_equal(check, "node", i, node, layout::none)) return false;
    if (absent) continue;
    if (!require_at_most(check, "node", i, node, first_of_level - 1.0)) return false;
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
  if (!require_size(check, section, level.counts->domain_count)) return false;
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    if (!verify_stencil(check, context.view, stencils[i], i, level.node_begin)) return false;
  }
  level.stencils = stencils;
  return true;
}

namespace {

// who stands on constraint level c for node i of level q
bool verify_representative(SectionCheck& check, const ModelView& view, std::uint32_t c, std::uint32_t q,
                           std::uint32_t i, std::uint32_t representative) {
  const NodeRecord& node = view.level[q].nodes[i];
  if (!has_flag(node, layout::node_touchable)) {
    return require_equal(check, "node", i, representative, layout::none);
  }
  // a node of K(c) stands for itself
  if (q <= c) return require_equal(check, "node", i, representative, view.level[q].node_begin + i);
  const std::uint32_t end = view.level[c].node_begin + view.level[c].counts->node_count;
  return require_at_most(check, "node", i, representative, end - 1.0) &&
         check.require(has_flag(node_at(view, representative), layout::node_domain), VerifyRule::inconsistent, "node",
                       i, representative, layout::none);
}

}  // namespace

bool verify_representatives(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t node_count = context.view.level[section.b].counts->node_count;
  const auto* representatives = section.as<std::uint32_t>();
  if (!require_size(check, section, node_count)) return false;
  for (std::uint32_t i = 0; i < node_count; ++i) {
    if (!verify_representative(check, context.view, section.a, section.b, i, representatives[i])) return false;
  }
  context.view.representatives[section.a][section.b] = representatives;
  return true;
}

namespace {

// Sylvester's criterion; the products of floats are exact or nearly so in double
bool verify_positive_definite(SectionCheck& check, const char* field, const float (&six)[6], std::uint32_t i) {
  for (const float value : six) {
    if (!require_finite(check, field, i, value)) return false;
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

}  // namespace

bool verify_scales(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  LevelView& level = context.view.level[section.a];
  const std::uint32_t count = level.counts->domain_count;
  const auto* scales = section.as<Scale>();
  if (!require_size(check, section, count)) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!verify_positive_definite(check, "root", scales[i].root, i) ||
        !verify_positive_definite(check, "diagonal", scales[i].diagonal, i)) {
      return false;
    }
  }
  level.scales = scales;
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

}  // namespace greenloop
