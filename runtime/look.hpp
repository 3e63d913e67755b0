#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/surface.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

/// How a body is looked at.
struct Look {
  Vec3 eye;             ///< m
  Vec3 direction;       ///< unit vector that it looks along
  float cosine = -1;    ///< of half the angle that it sees, -1..1; -1: all around
  float detail = 0;     ///< rad: edges that look shorter need not be halved; 0: as fine as there is
  float turned = 0.25;  ///< cosine up to which what faces away counts as seen, 0..1: for detail that stands out
};

/// What that sees.
struct Seen {
  static constexpr std::uint32_t most_halvings = 16;

  std::uint32_t triangles = 0;  ///< of the level that was asked for
  /// Of the surface's own edges, after which none that is seen looks longer than `detail`; most_halvings: no end.
  std::uint32_t halvings = 0;
};

/// Which triangles of a level of the surface are seen: those with a triangle of the surface's own level within them
/// that faces the eye and reaches into what it looks at, as displaced. Nothing hides anything. What is drawn of them,
/// all at one number of halvings, has no gaps. seen: [surface.triangle_count(q)] for some level q: 1 or 0.
/// displacement: of at least the surface's nodes, m; empty: at rest. Sees nothing, and writes zeros, if `look` is not
/// finite; writes nothing on a wrong size. For the loop; work: 80 operations a triangle of the surface's own level.
Seen look_at(const Surface& surface, std::span<const Vec4> displacement, const Look& look,
             std::span<std::uint8_t> seen) noexcept;

}  // namespace greenloop
