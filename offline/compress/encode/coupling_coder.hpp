#pragma once

#include <vector>

#include "formats/write/writer.hpp"
#include "offline/compress/wavelet/wavelet_compliance.hpp"

namespace greenloop::offline {

/// How couplings are thresholded and quantised. All are right to half a quantum and take as few bits as hold them; what
/// 16 bits do not hold stands in the first layer, of a coarser quantum, and what is left of it in another one.
struct Encoding {
  double threshold = 0;  ///< scaled blocks of smaller norm (Frobenius over root N) are dropped
  double quantum = 0;    ///< of scaled values
};

/// Fills in quanta, scales and couplings of every level. `model.levels` must have one entry per level of the
/// compliance, with its nodes. N: numbers of a node, 1 or 3. Throws std::runtime_error if a scaled value is above
/// 32767. Work: linear in the candidates.
template <unsigned N>
void encode_couplings(const WaveletCompliance<N>& compliance, const Encoding& encoding, ModelData& model);

}  // namespace greenloop::offline
