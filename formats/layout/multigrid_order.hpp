#pragma once

#include "formats/layout/multigrid.hpp"
#include "formats/layout/section_kinds.hpp"

namespace greenloop::layout {

/// Calls visit(kind, a, b) for each section of a multigrid model behind Provenance in file order, as long as it returns
/// true; returns whether it never did not. Writer and verifier go by it. Work: 9 calls a grid and 8.
template <class Visit>
bool visit_multigrid(const MultigridInfo& info, Visit visit) {
  constexpr SectionKind of_body[] = {SectionKind::level,   SectionKind::points,       SectionKind::tetrahedra,
                                     SectionKind::matters, SectionKind::shown_points, SectionKind::shown_triangles,
                                     SectionKind::bindings};
  constexpr SectionKind of_grid[] = {SectionKind::grid,          SectionKind::row_starts, SectionKind::row_uppers,
                                     SectionKind::columns,       SectionKind::blocks,     SectionKind::inverses,
                                     SectionKind::parent_starts, SectionKind::parents,    SectionKind::weights};
  for (const SectionKind kind : of_body) {
    if (!visit(kind, 0, 0)) return false;
  }
  for (std::uint32_t g = 0; g + 1 < info.grids; ++g) {
    for (const SectionKind kind : of_grid) {
      if (!visit(kind, g, 0)) return false;
    }
  }
  return visit(SectionKind::coarsest_factor, 0, 0);
}

}  // namespace greenloop::layout
