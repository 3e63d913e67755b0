#pragma once

#include "formats/layout/section_kinds.hpp"

namespace greenloop::layout {

/// The sections of level q of an elastostatic model in file order: calls visit(kind, a, b) for one after the other
/// until it returns false. Returns whether it never did. Writer and verifier go by it. Work: levels + layers calls.
template <class Visit>
bool visit_elastostatic_level(const Info& info, std::uint32_t q, Visit visit) {
  const auto wavelet = static_cast<Wavelet>(info.wavelet);
  const std::uint32_t first = info.coarsest_constraint_level;
  const bool base = q == 0, constrained = q >= first, loaded = info.loads > 0;
  if (!visit(SectionKind::level, q, 0) || !visit(SectionKind::nodes, q, 0)) return false;
  if (!(base ? visit(SectionKind::base_triangles, 0, 0) : visit(SectionKind::refinement, q, 0))) return false;
  if (base && loaded && !visit(SectionKind::loads, 0, 0)) return false;
  if (!base && is_butterfly(wavelet) && !visit(SectionKind::stencils, q, 0)) return false;
  if (!base && wavelet == Wavelet::equilibrated && !visit(SectionKind::predictions, q, 0)) return false;
  for (std::uint32_t c = first; c <= q; ++c) {
    if (!visit(SectionKind::representatives, c, q)) return false;
  }
  for (std::uint32_t r = 0; constrained && r < q; ++r) {
    if (!visit(SectionKind::representatives, q, r)) return false;
  }
  if (!visit(SectionKind::scales, q, 0)) return false;
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    if (!visit(SectionKind::couplings, q, layer)) return false;
  }
  if (constrained && !visit(SectionKind::patterns, q, 0)) return false;
  return !loaded || visit(SectionKind::load_columns, q, 0);
}

/// The sections of a ready file that follow all others, likewise. Work: layers + 2 calls.
template <class Visit>
bool visit_ready_sections(Visit visit) {
  if (!visit(SectionKind::read_marks, 0, 0) || !visit(SectionKind::base_columns, 0, 0)) return false;
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    if (!visit(SectionKind::mirrored_couplings, layer, 0)) return false;
  }
  return true;
}

}  // namespace greenloop::layout
