#pragma once

#include <cmath>

namespace greenloop {

/// A vector in space, in double: between single precision positions products are nearly exact. The order of operations
/// is fixed, so that every compiler and library gives the same bits.
struct Double3 {
  double x = 0, y = 0, z = 0;

  friend constexpr bool operator==(const Double3&, const Double3&) = default;
  friend constexpr Double3 operator+(const Double3& a, const Double3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Double3 operator-(const Double3& a, const Double3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Double3 operator-(const Double3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Double3 operator*(double s, const Double3& a) { return {s * a.x, s * a.y, s * a.z}; }
  constexpr Double3& operator+=(const Double3& b) { return *this = *this + b; }
};

constexpr double dot(const Double3& a, const Double3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr Double3 cross(const Double3& a, const Double3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The square root is rounded correctly by IEEE 754, so it is the same everywhere.
inline double norm(const Double3& a) { return std::sqrt(dot(a, a)); }

/// Zero stays zero.
inline Double3 unit(const Double3& a) {
  const double length = norm(a);
  return length > 0 ? (1 / length) * a : a;
}

/// A unit vector perpendicular to the unit vector `a`, continuous almost everywhere.
inline Double3 perpendicular(const Double3& a) {
  const double ax = std::abs(a.x), ay = std::abs(a.y), az = std::abs(a.z);
  const Double3 least = ax <= ay && ax <= az ? Double3{1, 0, 0} : ay <= az ? Double3{0, 1, 0} : Double3{0, 0, 1};
  return unit(least - dot(least, a) * a);
}

}  // namespace greenloop
