#pragma once

#include <cstdint>

#include "formats/writer.hpp"

namespace greenloop {

/// A small body for tests: an octahedron split onto a sphere of radius 0.1 m, held below z = -0.05 m.
struct SyntheticOptions {
  std::uint32_t levels = 3;                     ///< 1..6 mesh levels: 6, 18, 66, 258, 1026, 4098 nodes
  std::uint32_t coarsest_constraint_level = 0;  ///< < levels
  std::uint32_t value_bytes = 1;                ///< 1 or 2
  bool dense = false;                           ///< keep every block, without indices
  double epsilon = 0.01;                        ///< block threshold at the finest level
  double touchable_above = 0;                   ///< nodes with z >= this times the radius may be contacts; at most 1
};

/// A valid model of that body whose compliance is exp(-|x - y| / 0.05 m) times a constant symmetric positive definite
/// 3 x 3 matrix: symmetric positive definite, not elastic. Wavelet-transformed (lifted Linear), thresholded, quantised;
/// the errors in Level are measured. On the finest level the free nodes below z = -0.02 m are outside the domain.
/// Work: columns times nodes. Offline only, for tests and fuzzing.
[[nodiscard]] ModelData synthetic_model(const SyntheticOptions& options);

}  // namespace greenloop
