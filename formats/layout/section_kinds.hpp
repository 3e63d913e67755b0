#pragma once

#include <cstdint>

namespace greenloop::layout {

/// What a section holds. `a`, `b` of its entry: the indices in parentheses, else 0.
enum class SectionKind : std::uint32_t {
  info = 1,             ///< Info
  provenance = 2,       ///< UTF-8 text, no terminator
  level = 3,            ///< (q) Level
  nodes = 4,            ///< (q) NodeRecord[]
  base_triangles = 5,   ///< u32[3 * count]
  refinement = 6,       ///< (q) RefinementRecord[]
  representatives = 8,  ///< (c, q) u32[]
  scales = 10,          ///< (q) Scale[]
  couplings = 11,       ///< (q, layer) CouplingsHeader and its arrays
  stencils = 12,        ///< (q) StencilRecord[]
  patterns = 13,        ///< (q) PatternRecord[]
  predictions = 14,     ///< (q) PredictionsHeader and its arrays
};

}  // namespace greenloop::layout
