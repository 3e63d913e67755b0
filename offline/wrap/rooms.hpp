#pragma once

#include <cstddef>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/wrap/crossings.hpp"
#include "offline/wrap/lattice.hpp"

namespace greenloop::offline {

/// A part of space that faces keep apart from the outside, but for holes.
struct Room {
  double widest = 0;    ///< radius of the largest ball in it
  double hole = 0;      ///< radius of the largest ball that gets in from outside; 0 if it is shut
  bool inside = false;  ///< part of the body
};

/// Space, divided by faces.
struct Rooms {
  std::vector<int> room_of;  ///< per lattice point, an index into `rooms`
  std::vector<Room> rooms;   ///< the first one is the outside

  [[nodiscard]] bool inside(std::size_t point) const { return rooms[static_cast<std::size_t>(room_of[point])].inside; }
};

/// Divides the lattice along the crossed edges. A hole counts as shut if a ball twice as wide fits in behind it: seen
/// from the largest balls, rooms grow until they meet (the watershed of the distance; Meyer & Beucher, "Morphological
/// segmentation", 1990), so that the division runs through the hole where it is narrowest. A room that is shut is part
/// of the body. One with a hole is if faces with nothing behind them are most of its walls; else it is a hollow that
/// the body opens outwards, such as the inside of a bottle. The distances reach up to `band`. Memory: 13 bytes a point.
/// Work: nearly linear in points and crossings.
[[nodiscard]] Rooms find_rooms(const std::vector<float>& distance, const TriangleMesh& mesh,
                               const std::vector<Crossing>& crossings, const Lattice& lattice);

}  // namespace greenloop::offline
