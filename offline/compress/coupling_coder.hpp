#pragma once

#include <limits>

#include "formats/writer.hpp"
#include "offline/compress/compliance_pyramid.hpp"

namespace greenloop::offline {

/// How couplings are thresholded and quantised. All share one quantum and take as many bits as they need: 4 (weak), 8
/// (medium) or 16 (strong).
struct Encoding {
  double threshold = 0;  ///< scaled blocks of smaller norm (Frobenius over root 3) are dropped
  double quantum = 0;    ///< of scaled values
  /// Blocks that are larger than this relative to their coefficients' own diagonal blocks are strong whatever bits they
  /// need: what a field is made of.
  double field_threshold = std::numeric_limits<double>::infinity();
};

/// Fills in scales and couplings of every level. `model.levels` must have one entry per level of the pyramid. Work:
/// linear in the candidates.
void encode_couplings(const CompliancePyramid& pyramid, const Encoding& encoding, ModelData& model);

}  // namespace greenloop::offline
