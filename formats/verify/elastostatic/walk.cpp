#include "formats/verify/elastostatic/walk.hpp"

#include "formats/layout/elastostatic_order.hpp"
#include "formats/verify/elastostatic/sections.hpp"
#include "formats/verify/provenance.hpp"

namespace greenloop::elastostatic {
namespace {

using layout::SectionKind;

bool verify_section(const Section& section, VerifyContext& context) {
  switch (section.kind) {
    case SectionKind::level:
      return verify_level(section, context);
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) \
  case SectionKind::kind:                                           \
    return verify_##kind(section, context);
      GREENLOOP_ELASTOSTATIC_SECTIONS(GREENLOOP_ROW)
      GREENLOOP_READY_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
    default:
      return false;  // no other kind is in the order
  }
}

}  // namespace

namespace {

// What a body takes grows with the pairs of its contacts and the domain's nodes.
bool verify_contacts(const Section& info, std::uint64_t file_bytes, const VerifyContext& context) {
  const ElastostaticView& view = context.view;
  const std::uint64_t domain = view.domain_count;
  const std::uint64_t most = layout::contact_pairs_per_byte * file_bytes / (domain > 0 ? domain : 1);
  const std::uint64_t contacts = view.info->max_contacts;
  return SectionCheck(info, context.result)
      .require(domain <= most || contacts <= most, VerifyRule::out_of_range, "max_contacts", 0,
               static_cast<double>(contacts), static_cast<double>(most));
}

}  // namespace

bool verify_sections(const Section& info, SectionTable& table, ModelView& view, VerifyResult& result) {
  VerifyContext context{view, result, table.header().levels, table.reserved_is_zero()};
  if (!verify_info(info, context) || !verify_provenance(table, view, result)) return false;
  const auto next = [&](SectionKind kind, std::uint32_t a, std::uint32_t b) {
    Section section;
    return table.take(kind, a, b, section, result) && verify_section(section, context);
  };
  for (std::uint32_t q = 0; q < context.levels; ++q) {
    if (!layout::visit_elastostatic_level(*context.view.info, q, next) || !verify_counts(q, context)) return false;
  }
  if (!verify_contacts(info, view.header->file_bytes, context)) return false;
  if (table.is_next(SectionKind::vertex_map) && !next(SectionKind::vertex_map, 0, 0)) return false;
  return !table.is_next(SectionKind::read_marks) || layout::visit_ready_sections(next);
}

}  // namespace greenloop::elastostatic
