#include "runtime/contact/proxy.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "runtime/contact/cast.hpp"
#include "runtime/testing/deformed_body.hpp"

namespace greenloop {
namespace {

constexpr double margin = 0.01;

struct Follower {
  explicit Follower(const DeformedBody& of) : body(of) {}
  void move(const Double3& to) {
    std::uint64_t work = 0;
    proxy.move(body.surface, to, margin, work);
    CHECK(work <= Proxy::move_work(body.surface));
  }
  const DeformedBody& body;
  Proxy proxy;
};

TrianglePoint cast(const DeformedBody& body, const Double3& from, const Double3& to) {
  std::uint64_t work = 0;
  const TrianglePoint point = cast(body.surface, from, to, {}, work);
  CHECK(work <= cast_work(body.surface));
  return point;
}

TEST_CASE("cast: a way enters where it first meets the surface from outside, and not where it leaves") {
  const DeformedBody body({.levels = 4});
  const TrianglePoint point = cast(body, {0.2, 0.001, 0.002}, {-0.2, 0.001, 0.002});
  REQUIRE(point.triangle != layout::none);
  const Double3 at = body.surface.position(point);
  CHECK(at.x > 0.09);
  CHECK(at.y == doctest::Approx(0.001).epsilon(1e-5));
  CHECK(at.z == doctest::Approx(0.002).epsilon(1e-5));
  CHECK(cast(body, {0, 0, 0}, {0.2, 0.01, 0}).triangle == layout::none);
  CHECK(cast(body, {0.2, 0, 0}, {0.101, 0, 0}).triangle == layout::none);
  CHECK(cast(body, {0.2, 0.11, 0}, {-0.2, 0.11, 0}).triangle == layout::none);
  CHECK(cast(body, {0.2, 0, 0}, {0.2, 0, 0}).triangle == layout::none);
}

TEST_CASE("cast: no way leads through corners, edges and what lies between, from wherever it comes") {
  const DeformedBody body({.levels = 3});
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> share(0, 1), anywhere(-1, 1);
  for (std::uint32_t t = 0; t < body.surface.triangle_count(); ++t) {
    for (int i = 0; i < 60; ++i) {
      const double a = i % 3 == 0 ? 1 : share(random), b = i % 3 == 2 ? share(random) * (1 - a) : 1 - a;
      const Double3 goal = body.surface.position(TrianglePoint{t, {a, b, 1 - a - b}});
      const Double3 outside = 0.3 * unit(goal + 0.05 * Double3{anywhere(random), anywhere(random), anywhere(random)});
      const Double3 inside = goal + 0.1 * (goal - outside);
      if (!(norm(inside) < 0.09)) continue;
      REQUIRE(cast(body, outside, inside).triangle != layout::none);
      REQUIRE(cast(body, outside + 1000 * (outside - inside), inside).triangle != layout::none);
    }
  }
}

TEST_CASE("cast: of a way from a point of the surface the triangles there are passed over") {
  const DeformedBody body({.levels = 3});
  const TrianglePoint corner{7, {1, 0, 0}};
  const Double3 at = body.surface.position(corner);
  std::uint64_t work = 0;
  CHECK(cast(body.surface, at, 0.5 * at, {}, work).triangle != layout::none);
  CHECK(cast(body.surface, at, 0.5 * at, corner, work).triangle == layout::none);
}

TEST_CASE("proxy: a free one is the nearest point of the surface, a far one has none") {
  const DeformedBody body({.levels = 4});
  Follower follower(body);
  follower.move({0.3, 0, 0});
  CHECK(!follower.proxy.is_held());
  CHECK(follower.proxy.point().triangle == layout::none);
  follower.move({0.105, 0.003, 0.001});
  CHECK(!follower.proxy.is_held());
  REQUIRE(follower.proxy.point().triangle != layout::none);
  const Double3 way = Double3{0.105, 0.003, 0.001} - follower.proxy.position();
  CHECK(follower.proxy.height() == doctest::Approx(norm(way)).epsilon(1e-12));
  CHECK(norm(follower.proxy.normal() - unit(way)) < 1e-9);
}

TEST_CASE("proxy: one that is pushed in is held, slides along and is let go where it comes out") {
  const DeformedBody body({.levels = 4});
  Follower follower(body);
  follower.move({0.12, 0, 0});
  follower.move({0.09, 0, 0});
  REQUIRE(follower.proxy.is_held());
  CHECK(follower.proxy.height() == doctest::Approx(-0.01).epsilon(0.02));
  CHECK(follower.proxy.normal().x > 0.9);
  follower.move({0, 0.09, 0});
  REQUIRE(follower.proxy.is_held());
  CHECK(follower.proxy.normal().y > 0.9);
  CHECK(follower.proxy.position().y > 0.09);
  follower.move({0, 0.105, 0});
  CHECK(!follower.proxy.is_held());
  CHECK(follower.proxy.height() == doctest::Approx(0.005).epsilon(1e-5));
}

TEST_CASE("proxy: what is placed inside is held where the surface is nearest; what is forgotten is placed anew") {
  const DeformedBody ear = thin_ear();
  Follower follower(ear);
  follower.move({2e-4, 0.02, 0.01});
  REQUIRE(follower.proxy.is_held());
  CHECK(follower.proxy.normal().x > 0.9);
  follower.proxy.forget();
  follower.move({-2e-4, 0.02, 0.01});
  REQUIRE(follower.proxy.is_held());
  CHECK(follower.proxy.normal().x < -0.9);
}

TEST_CASE(
    "proxy: a tool that passes a thin ear in one step is held on the side that it came from, until it comes back") {
  const DeformedBody ear = thin_ear();
  for (const double side : {1.0, -1.0}) {
    Follower follower(ear);
    follower.move({side * 0.005, 0.01, 0.02});
    for (const double behind : {-0.005, -0.05, -0.02, -1e-5}) {
      follower.move({side * behind, 0.012, 0.02});
      REQUIRE(follower.proxy.is_held());
      CHECK(side * follower.proxy.normal().x > 0.9);
      CHECK(follower.proxy.height() == doctest::Approx(behind - 0.001).epsilon(0.2));
    }
    follower.move({side * 0.002, 0.012, 0.02});
    CHECK(!follower.proxy.is_held());
  }
}

TEST_CASE("proxy: around the rim of the ear, and only there, it comes to the other side") {
  const DeformedBody ear = thin_ear();
  Follower follower(ear);
  follower.move({0.01, 0, 0});
  follower.move({-0.01, 0, 0});
  for (int i = 0; i <= 20; ++i) {
    CHECK(follower.proxy.is_held() == (i < 20));
    follower.move({-0.01, 0.005 * (i + 1), 0});
  }
}

TEST_CASE("proxy: a free one that the body moves over is held on the side where it was") {
  DeformedBody ear = thin_ear();
  Follower follower(ear);
  follower.move({0.004, 0, 0});
  CHECK(!follower.proxy.is_held());
  for (Vec4& u : ear.displacement) u.x = 0.02F;
  ear.update();
  follower.move({0.005, 0, 0});
  REQUIRE(follower.proxy.is_held());
  CHECK(follower.proxy.normal().x > 0.9);
  CHECK(follower.proxy.height() == doctest::Approx(-0.016).epsilon(0.1));
  for (Vec4& u : ear.displacement) u.x = 0;
  ear.update();
  follower.move({0.005, 0, 0});
  CHECK(!follower.proxy.is_held());
}

}  // namespace
}  // namespace greenloop
