#pragma once

#include "formats/layout/impulse_response.hpp"
#include "formats/layout/section_kinds.hpp"

namespace greenloop::layout {

/// Calls visit(kind, a, b) for each section of level q of an impulse response model in file order, as long as it
/// returns true; returns whether it never did not. Writer and verifier go by it. Work: planes + 10 calls.
template <class Visit>
bool visit_impulse_response_level(const ImpulseInfo& info, std::uint32_t q, Visit visit) {
  constexpr SectionKind of_all_levels[] = {SectionKind::shape,     SectionKind::triangles,   SectionKind::quanta,
                                           SectionKind::impulses,  SectionKind::successions, SectionKind::orbits,
                                           SectionKind::references};
  if (!visit(SectionKind::level, q, 0)) return false;
  for (const SectionKind kind : of_all_levels) {
    if (q == 0 && !visit(kind, 0, 0)) return false;
  }
  for (std::uint32_t plane = 0; plane < info.planes; ++plane) {
    if (!visit(SectionKind::modes, q, plane)) return false;
  }
  return visit(SectionKind::amplitudes, q, 0) && visit(SectionKind::coordinates, q, 0);
}

/// The same for the sections behind the last level of a model that is complete. Work: 4 calls.
template <class Visit>
bool visit_appearance(const ImpulseInfo& info, Visit visit) {
  return info.transfer_modes == 0 ||
         (visit(SectionKind::transfer_quanta, 0, 0) && visit(SectionKind::transfers, 0, 0) &&
          visit(SectionKind::transfer_amplitudes, 0, 0) && visit(SectionKind::transfer_coordinates, 0, 0));
}

}  // namespace greenloop::layout
