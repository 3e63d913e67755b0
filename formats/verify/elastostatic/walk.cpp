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
  if (table.is_next(SectionKind::vertex_map) && !next(SectionKind::vertex_map, 0, 0)) return false;
  return !table.is_next(SectionKind::read_marks) || layout::visit_ready_sections(next);
}

}  // namespace greenloop::elastostatic
