#pragma once

#include <cstddef>
#include <vector>

#include "offline/wrap/lattice.hpp"

namespace greenloop::offline {

/// Pieces of a field's inside, by the lattice points in each, the largest first.
using Pieces = std::vector<std::size_t>;

/// Leaves of the inside, where the field is negative, the largest piece, without hollows, and returns all pieces there
/// were; no points at all if there is no inside.
Pieces keep_largest_piece(std::vector<float>& field, const Lattice& lattice);

/// Adds points to the inside where it meets itself in an edge or a corner only, so that the surface around it is a
/// manifold (well-composed sets: Latecki, "3D well-composed pictures", 1997). Work: linear, and a bit for each point.
void make_well_composed(std::vector<float>& field, const Lattice& lattice);

}  // namespace greenloop::offline
