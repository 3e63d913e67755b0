#include "formats/verify/multigrid/walk.hpp"

#include "formats/layout/multigrid_order.hpp"
#include "formats/verify/multigrid/sections.hpp"
#include "formats/verify/provenance.hpp"

namespace greenloop::multigrid {
namespace {

using layout::SectionKind;

bool verify_section(const Section& section, VerifyContext& context) {
  switch (section.kind) {
    case SectionKind::level:
      return verify_level(section, context);
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) \
  case SectionKind::kind:                                           \
    return verify_##kind(section, context);
      GREENLOOP_MULTIGRID_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
    default:
      return false;  // no other kind is in the order
  }
}

}  // namespace

bool verify_sections(const Section& info, SectionTable& table, ModelView& view, VerifyResult& result) {
  VerifyContext context{view.multigrid, result, table.header().levels, table.reserved_is_zero()};
  if (!verify_info(info, context) || !verify_provenance(table, view, result)) return false;
  return layout::visit_multigrid(*context.view.info, [&](SectionKind kind, std::uint32_t a, std::uint32_t b) {
    Section section;
    return table.take(kind, a, b, section, result) && verify_section(section, context);
  });
}

}  // namespace greenloop::multigrid
