#pragma once

#include <cstdint>

#include "runtime/vec.hpp"

namespace greenloop {

/// Light from far around a scene, of low frequency: radiance from direction d (of unit length, towards the light) is
/// the sum of coefficients times real spherical harmonics up to degree 3, in any unit, of three colours. Coefficient l
/// (l + 1) + m is that of degree l and order m = -l..l (Sloan, Kautz & Snyder 2002).
struct Light {
  static constexpr std::uint32_t coefficients = 16;
  float red[coefficients] = {}, green[coefficients] = {}, blue[coefficients] = {};
};

/// The harmonics of a direction of unit length, orthonormal over the sphere: 1/2 sqrt(1/pi), sqrt(3/4pi) (y, z, x),
/// and so on, without the sign (-1)^m. For the loop; work: constant.
void light_harmonics(const Vec3& direction, float (&value)[Light::coefficients]) noexcept;

/// The light turned by a rotation, row by row: what came from d comes from `rotation` d. Lights a scene that is turned
/// the other way. For the loop; work: constant, 5,000 multiplications.
[[nodiscard]] Light rotated(const Light& light, const float (&rotation)[9]) noexcept;

}  // namespace greenloop
