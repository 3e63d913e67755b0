#pragma once

#include <cstdint>

#include "formats/writer.hpp"
#include "offline/compress/compliance_pyramid.hpp"

namespace greenloop::offline {

/// How couplings are thresholded and quantised. Scaled couplings are at most 1; a block that fits in 4 bits at
/// `weak_quantum` is weak, any other strong.
struct Encoding {
  double threshold = 0;       ///< scaled blocks of smaller norm (Frobenius over root 3) are dropped
  double weak_quantum = 0;    ///< of weak couplings; the strong ones' follows from their largest value
  std::uint32_t strong_bits = 8;  ///< 8 or 16
};

/// Fills in scales and couplings of every level. `model.levels` must have one entry per level of the pyramid. Work:
/// linear in the candidates.
void encode_couplings(const CompliancePyramid& pyramid, const Encoding& encoding, ModelData& model);

}  // namespace greenloop::offline
