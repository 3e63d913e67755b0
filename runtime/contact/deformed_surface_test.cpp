#include "runtime/contact/deformed_surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/deformed_body.hpp"

namespace greenloop {
namespace {

Double3 random_vector(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> anywhere(-size, size);
  const double x = anywhere(random), y = anywhere(random), z = anywhere(random);
  return {x, y, z};
}

// bends the body, and roughens it
void deform(DeformedBody& body, std::mt19937_64& random, double size) {
  const Double3 along = random_vector(random, 1);
  for (std::uint32_t i = 0; i < body.displacement.size(); ++i) {
    const Double3 rough = random_vector(random, 0.02 * size);
    const Double3& at = body.surface.position(i);
    const double bend = 50 * size * at.z * at.z;
    body.displacement[i] = {static_cast<float>(bend * along.x + rough.x), static_cast<float>(bend * along.y + rough.y),
                            static_cast<float>(bend * along.z + rough.z), 0};
  }
  body.update();
}

ClosestSurfacePoint searched(const DeformedSurface& surface, const Double3& from) {
  ClosestSurfacePoint best = surface.closest_in(0, from);
  for (std::uint32_t t = 1; t < surface.triangle_count(); ++t) {
    const ClosestSurfacePoint found = surface.closest_in(t, from);
    if (found.squared_distance < best.squared_distance) best = found;
  }
  return best;
}

// the solid angle under which the surface is seen, over 4 pi (van Oosterom & Strackee 1983)
double winding_number(const DeformedSurface& surface, const Double3& from) {
  double sum = 0;
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    const auto& [i, j, k] = surface.triangle(t).node;
    const Double3 a = unit(surface.position(i) - from), b = unit(surface.position(j) - from),
                  c = unit(surface.position(k) - from);
    sum += 2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
  }
  return sum / (4 * 3.14159265358979323846);
}

TEST_CASE("deformed surface: the closest point is that of a search of all triangles, whatever is guessed") {
  std::mt19937_64 random(21);
  for (const float thickness : {1.0F, 0.01F}) {
    DeformedBody body({.levels = 4}, thickness);
    for (int round = 0; round < 20; ++round) {
      deform(body, random, round == 0 ? 0 : 0.02);
      for (int i = 0; i < 30; ++i) {
        const Double3 from = random_vector(random, 0.12);
        const ClosestSurfacePoint expected = searched(body.surface, from);
        std::uint64_t work = 0;
        for (const std::uint32_t guess : {layout::none, 7U, expected.point.triangle}) {
          const ClosestSurfacePoint found = body.surface.closest(from, guess, work);
          REQUIRE(found.point.triangle == expected.point.triangle);
          REQUIRE(found.squared_distance == expected.squared_distance);
          REQUIRE(std::equal(found.point.weight, found.point.weight + 3, expected.point.weight));
        }
        CHECK(work <= 3 * body.surface.closest_work());
        const Double3 offset = body.surface.position(expected.point) - from;
        CHECK(dot(offset, offset) == doctest::Approx(expected.squared_distance).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("deformed surface: what is on the closest point's outer side is outside, of a sharp rim too") {
  std::mt19937_64 random(22);
  int inside = 0;
  for (const float thickness : {1.0F, 0.05F}) {
    DeformedBody body({.levels = 3}, thickness);
    for (int round = 0; round < 10; ++round) {
      deform(body, random, 0.002);
      for (int i = 0; i < 300; ++i) {
        Double3 from = random_vector(random, 0.11);
        from.x *= thickness;
        const double winding = winding_number(body.surface, from);
        REQUIRE(std::abs(winding - std::round(winding)) < 1e-6);
        std::uint64_t work = 0;
        const TrianglePoint point = body.surface.closest(from, layout::none, work).point;
        work = 0;
        const double height = dot(from - body.surface.position(point), body.surface.normal(point, work));
        CHECK(work <= body.surface.surround_work());
        REQUIRE((height < 0) == (winding > 0.5));
        inside += height < 0 ? 1 : 0;
      }
    }
  }
  CHECK(inside > 500);
}

TEST_CASE("deformed surface: the patches have every triangle once and own every node once, in their boxes") {
  for (const std::uint32_t levels : {1U, 2U, 3U, 5U}) {
    std::mt19937_64 random(23);
    DeformedBody body({.levels = levels});
    deform(body, random, 0.05);
    std::vector<int> triangles(body.surface.triangle_count()), nodes(body.surface.node_count());
    std::uint64_t boxes = 0;
    TriangleBox last{};
    const auto is_in = [&](const Double3& at) { return squared_distance(last, at) == 0; };
    body.surface.visit(
        [&](const TriangleBox& box) {
          ++boxes;
          last = box;
          return true;
        },
        [&](std::uint32_t patch) {
          for (const std::uint32_t t : body.surface.triangles_of(patch)) {
            ++triangles[t];
            for (const std::uint32_t node : body.surface.triangle(t).node) CHECK(is_in(body.surface.position(node)));
          }
          for (const std::uint32_t node : body.surface.own_nodes_of(patch)) {
            ++nodes[node];
            CHECK(is_in(body.surface.position(node)));
          }
        });
    CHECK(boxes == body.surface.box_count());
    CHECK(triangles == std::vector<int>(triangles.size(), 1));
    CHECK(nodes == std::vector<int>(nodes.size(), 1));
  }
}

TEST_CASE("deformed surface: the triangles around a point are those that it lies in") {
  const DeformedBody body({.levels = 3});
  const auto around = [&](const TrianglePoint& point) {
    std::vector<std::uint32_t> found;
    body.surface.visit_around(point, [&](std::uint32_t t) { found.push_back(t); });
    return found;
  };
  CHECK(around({5, {0.25, 0.25, 0.5}}) == std::vector<std::uint32_t>{5});
  for (std::uint32_t t = 0; t < body.surface.triangle_count(); ++t) {
    CHECK(around({t, {0, 0.25, 0.75}}).size() == 2);
    std::vector<std::uint32_t> expected;
    const std::uint32_t node = body.surface.triangle(t).node[2];
    for (std::uint32_t s = 0; s < body.surface.triangle_count(); ++s) {
      const auto& [a, b, c] = body.surface.triangle(s).node;
      if (a == node || b == node || c == node) expected.push_back(s);
    }
    CHECK(around({t, {0, 0, 1}}) == expected);
  }
}

TEST_CASE("deformed surface: too few displacements are refused, memory that is too small too") {
  DeformedBody body({.levels = 2});
  const Double3 before = body.surface.position(3);
  std::vector<Vec4> few(body.surface.node_count() - 1, Vec4{1, 1, 1, 0});
  std::uint64_t work = 0;
  CHECK(!body.surface.update(few, work));
  CHECK(work == 0);
  CHECK(body.surface.position(3) == before);
  CHECK(body.surface.update({}, work));
  CHECK(work == body.surface.update_work());
}

}  // namespace
}  // namespace greenloop
