#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "offline/appearance/ray_scene.hpp"

namespace greenloop::offline {

/// How finely light is followed.
struct TransferGoal {
  std::uint32_t rays = 256;     ///< from each vertex, rounded up to a square number
  std::uint32_t bounces = 256;  ///< of light between parts of the surface, at most; 0: what comes from outside alone
  double change = 1e-4;         ///< bounces end where one changes the transfer by less, relative
  std::uint64_t seed = 0;       ///< of the rays' directions
};

/// Diffuse interreflected radiance transfer (Sloan, Kautz & Snyder 2002): [48][vertices], the exit radiance of a vertex
/// in red is the sum of rows 0..15 times the coefficients of red light (runtime/light.hpp), in green and blue of rows
/// 16..31 and 32..47. Rays leave each vertex with the density of the cosine law, in strata of the hemisphere; what they
/// meet is interpolated between its corners, and light goes on until a bounce changes nothing. The back of a triangle
/// is black. Vertices without a triangle are black. Throws what RayScene throws. Work: vertices times rays times
/// log(triangles), and 150 multiplications for each ray that meets the surface and bounce. Memory: 16 bytes for each of
/// these, 400 for each vertex.
[[nodiscard]] Eigen::MatrixXf radiance_transfer(const LitSurface& surface, const TransferGoal& goal);

}  // namespace greenloop::offline
