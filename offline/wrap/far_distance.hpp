#pragma once

#include <cstdint>
#include <vector>

#include "offline/wrap/lattice.hpp"

namespace greenloop::offline {

/// Continues distances that are known up to `band` to all points: from those within 1, by less than half a spacing too
/// short (Felzenszwalb & Huttenlocher, "Distance transforms of sampled functions", 2012). Work: linear.
[[nodiscard]] std::vector<float> far_distance(const std::vector<float>& distance, const Lattice& lattice);

/// The distance of every point to the nearest one of a set (per point, nonzero: belongs to it), 1e6 if that is empty.
/// Work: linear.
[[nodiscard]] std::vector<float> distance_to(const std::vector<std::uint8_t>& set, const Lattice& lattice);

}  // namespace greenloop::offline
