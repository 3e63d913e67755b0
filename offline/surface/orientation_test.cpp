#include "offline/surface/orientation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

using Eigen::Vector2d;
using Eigen::Vector3d;
using greenloop::offline::orientation;

namespace {

/// Coordinates on a grid of 2^-20, so that the determinant is exact in 128-bit whole numbers.
class Grid {
 public:
  std::int64_t next(std::int64_t range) { return static_cast<std::int64_t>(random_() % (2 * range + 1)) - range; }

 private:
  std::mt19937_64 random_{20030703};
};

using Point = std::array<std::int64_t, 3>;
__extension__ using Wide = __int128;

int exact(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto u = [&](int i) { return Wide{b[i] - a[i]}; };
  const auto v = [&](int i) { return Wide{c[i] - a[i]}; };
  const auto w = [&](int i) { return Wide{d[i] - a[i]}; };
  const Wide det =
      u(0) * (v(1) * w(2) - v(2) * w(1)) + u(1) * (v(2) * w(0) - v(0) * w(2)) + u(2) * (v(0) * w(1) - v(1) * w(0));
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

Vector3d scaled(const Point& p) {
  return Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])) * std::exp2(-20);
}

}  // namespace

TEST_CASE("the unit tetrahedron is positive") {
  CHECK(orientation(Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()) == 1);
  CHECK(orientation(Vector3d::Zero(), Vector3d::UnitY(), Vector3d::UnitX(), Vector3d::UnitZ()) == -1);
}

TEST_CASE("counter-clockwise is positive") {
  CHECK(orientation(Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1)) == 1);
  CHECK(orientation(Vector2d(0, 0), Vector2d(0, 1), Vector2d(1, 0)) == -1);
}

TEST_CASE("nearly flat tetrahedra agree with whole-number arithmetic, seed 20030703") {
  Grid grid;
  int flat = 0;
  int wrong = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    const Point a{grid.next(1 << 20), grid.next(1 << 20), grid.next(1 << 20)};
    const Point b{grid.next(1 << 20), grid.next(1 << 20), grid.next(1 << 20)};
    const Point c{grid.next(1 << 20), grid.next(1 << 20), grid.next(1 << 20)};
    Point d{};
    const auto s = grid.next(8);
    const auto t = grid.next(8);
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]) + grid.next(1) * (trial % 2);
    }
    const int expected = exact(a, b, c, d);
    flat += expected == 0 ? 1 : 0;
    wrong += orientation(scaled(a), scaled(b), scaled(c), scaled(d)) != expected ? 1 : 0;
  }
  CHECK(wrong == 0);
  CHECK(flat > 90000);
}

TEST_CASE("a point moved by the last bit off a line is seen, where the plain formula is blind") {
  // Kettner et al., "Classroom examples of robustness problems in geometric computations": points near y = x.
  const double bit = std::exp2(-53);
  int plain_wrong = 0;
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const Vector2d p(0.5 + i * bit, 0.5 + j * bit);
      const Vector2d q(12, 12);
      const Vector2d r(24, 24);
      const int expected = (p.y() > p.x() ? 1 : 0) - (p.y() < p.x() ? 1 : 0);
      // q -> r runs along y = x, left of it is y > x
      CHECK(orientation(p, q, r) == expected);
      const double plain = (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
      plain_wrong += ((plain > 0 ? 1 : 0) - (plain < 0 ? 1 : 0)) != expected ? 1 : 0;
    }
  }
  CHECK(plain_wrong > 100);
}
