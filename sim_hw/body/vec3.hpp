#pragma once

#include <cmath>

namespace greenloop {

/// A vector in space, in double. Own fixed-order operations: the same bits with every compiler and library.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
};

constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The square root is rounded correctly by IEEE 754, so it is the same everywhere.
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// Zero stays zero.
inline Vec3 unit(const Vec3& a) {
  const double length = norm(a);
  return length > 0 ? (1 / length) * a : a;
}

/// A unit vector perpendicular to the unit vector `a`, continuous almost everywhere.
inline Vec3 perpendicular(const Vec3& a) {
  const double ax = std::abs(a.x), ay = std::abs(a.y), az = std::abs(a.z);
  const Vec3 least = ax <= ay && ax <= az ? Vec3{1, 0, 0} : ay <= az ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return unit(least - dot(least, a) * a);
}

}  // namespace greenloop
