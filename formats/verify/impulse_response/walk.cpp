#include "formats/verify/impulse_response/walk.hpp"

#include "formats/layout/impulse_response_order.hpp"
#include "formats/verify/impulse_response/sections.hpp"
#include "formats/verify/provenance.hpp"

namespace greenloop::impulse_response {
namespace {

using layout::SectionKind;

bool verify_section(const Section& section, VerifyContext& context) {
  switch (section.kind) {
    case SectionKind::level:
      return verify_level(section, context);
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) \
  case SectionKind::kind:                                           \
    return verify_##kind(section, context);
      GREENLOOP_IMPULSE_RESPONSE_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
    default:
      return false;  // no other kind is in the order
  }
}

// the levels of a complete file hold all of its modes
bool verify_mode_counts(const Section& info, const VerifyContext& context) {
  const ImpulseResponseView& view = context.view;
  SectionCheck check(info, context.result);
  return view.levels == view.info->levels ? check.require_equal("modes", 0, view.info->modes, view.modes)
                                          : check.require_at_least("modes", 0, view.info->modes, view.modes);
}

}  // namespace

bool verify_sections(const Section& info, SectionTable& table, ModelView& view, VerifyResult& result) {
  VerifyContext context{view.impulse_response, result, table.header().levels, table.reserved_is_zero()};
  if (!verify_info(info, context) || !verify_provenance(table, view, result)) return false;
  const auto next = [&](SectionKind kind, std::uint32_t a, std::uint32_t b) {
    Section section;
    return table.take(kind, a, b, section, result) && verify_section(section, context);
  };
  for (std::uint32_t q = 0; q < context.levels; ++q) {
    if (!layout::visit_impulse_response_level(*context.view.info, q, next)) return false;
    context.view.levels = q + 1;
  }
  if (!verify_mode_counts(info, context)) return false;
  // a file that was cut has no appearance
  return context.levels < context.view.info->levels || layout::visit_appearance(*context.view.info, next);
}

}  // namespace greenloop::impulse_response
