#pragma once

#include <vector>

#include "offline/wrap/lattice.hpp"

namespace greenloop::offline {

/// Makes the inside of a field, where it is negative, simpler than `radius`, in spacings: parts thinner than twice that
/// are thickened to it about their middle, gaps narrower than that closed, edges and corners rounded. Nothing moves by
/// more than about the radius. The field becomes a distance, smoothed by a third of the radius. (Openings and closings
/// by a ball: Serra, "Image analysis and mathematical morphology", 1982.) Memory: 16 bytes a point. Work: linear.
void round_solid(std::vector<float>& field, const Lattice& lattice, double radius);

}  // namespace greenloop::offline
