#include "runtime/relief.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/split_surface.hpp"

namespace greenloop {
namespace {

TEST_CASE("the slope at a point is linear between the vertices of the last level") {
  const TestModel model({.levels = 3});
  const SplitSurface split(model, 2, {3, FinerSurface::Rule::midpoint});
  std::vector<Vec3> slope;
  for (const Vec4& x : split.positions(3)) slope.push_back({x.x, 2 * x.y, x.z - x.x});
  const auto corner = split.positions(0);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(0, 1);
  for (int i = 0; i < 500; ++i) {
    const std::uint32_t t = static_cast<std::uint32_t>(random()) % split.finer.triangle_count(0);
    float u = any(random), v = any(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const float weight[3] = {u, v, 1 - u - v};
    Double3 x;
    for (int k = 0; k < 3; ++k) x += double{weight[k]} * exact(corner[split.finer.triangle(0, t).node[k]]);
    const Vec3 found = relief_slope(split.finer, slope, t, weight);
    CHECK(std::abs(found.x - x.x) < 1e-7);
    CHECK(std::abs(found.y - 2 * x.y) < 1e-7);
    CHECK(std::abs(found.z - (x.z - x.x)) < 1e-7);
  }
  const float middle[3] = {0.25F, 0.25F, 0.5F};
  CHECK(relief_slope(split.finer, {slope.data(), 5}, 0, middle).x == 0);
  CHECK(relief_slope(split.finer, slope, split.finer.triangle_count(0), middle).x == 0);
}

TEST_CASE("a normal map says slopes") {
  const std::vector<Vec4> normal(5, Vec4{0, 0, 1, 0});
  const std::vector<Vec3> detail{{0, 0, 2}, {-0.5F, 0, 1}, {-100, 0, 1}, {0, 0, -1}, {std::nanf(""), 0, 1}};
  std::vector<Vec3> slope(5, Vec3{7, 7, 7});
  CHECK(!relief_slopes(normal, detail, {slope.data(), 4}));
  REQUIRE(relief_slopes(normal, detail, slope));
  const float expected[] = {0, 0.5F, most_slope, 0, 0};  // it rises along x where the normal leans back
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(slope[i].x == doctest::Approx(expected[i]));
    CHECK(slope[i].y == 0);
    CHECK(slope[i].z == 0);
  }
}

ContactBody::Contact contact_at(std::uint32_t node, double pressed) {
  ContactBody::Contact contact;
  contact.node[0] = node;
  contact.node[1] = contact.node[2] = layout::none;
  contact.weight[0] = 1;
  contact.normal = {0, 0, -1};
  contact.force = {0.1, 0, -pressed};
  return contact;
}

TEST_CASE("friction is larger uphill and smaller downhill, never below 0, and itself without a motion") {
  const TestModel model({.levels = 3});
  const SplitSurface split(model, 2, {1, FinerSurface::Rule::midpoint});
  std::vector<Vec3> slope(split.finer.vertex_count(1));
  slope[3] = {0.2F, 0, 0.7F};
  const std::vector contacts{contact_at(3, 2), contact_at(4, 6), contact_at(5, 0)};
  const auto friction = [&](const Double3& way) { return relief_friction(split.finer, slope, 0.3, way, contacts); };
  CHECK(friction({1e-3, 0, 0}) == doctest::Approx(0.3 + 0.25 * 0.2));
  CHECK(friction({-1e-3, 0, 0}) == doctest::Approx(0.3 - 0.25 * 0.2));
  CHECK(friction({0, 1e-3, 0}) == doctest::Approx(0.3));
  CHECK(friction({0, 0, 1e-3}) == doctest::Approx(0.3));
  CHECK(friction({}) == 0.3);
  CHECK(friction({1e-6, 0, 0}) == doctest::Approx(0.3 + 0.25 * 0.1));
  slope[3].x = 2;
  CHECK(friction({-1e-3, 0, 0}) == doctest::Approx(0.75 * 0.3));
  CHECK(relief_friction(split.finer, slope, 0.3, {1, 0, 0}, {}) == 0.3);
  CHECK(relief_friction(split.finer, {slope.data(), 4}, 0.3, {1, 0, 0}, contacts) == 0.3);
}

TEST_CASE("a ball that slides over ridges feels them, and energy only goes") {
  const TestModel model({.levels = 4});
  const SplitSurface split(model, 3, {2, FinerSurface::Rule::midpoint});
  constexpr double ridge = 0.02, height = 0.2;  // m, and the largest slope along x
  std::vector<Vec3> slope;
  for (const Vec4& x : split.positions(2))
    slope.push_back({static_cast<float>(height * std::sin(6.2832 / ridge * x.x)), 0, 0});
  ContactBody::Limits limits;
  limits.elastostatic = {.max_contacts = 64, .cached_factors = 4, .iterations = 50};
  AlignedBytes memory(ContactBody::required(model.model(), limits).bytes);
  ContactBody body = ContactBody::create(model.model(), limits, {memory.data(), memory.size()}).body;
  constexpr double radius = 0.03, friction = 0.4, step = 2e-4;
  double least = 1, most = 0;
  Double3 last;
  for (int k = 0; k < 400; ++k) {
    const double angle = -0.4 + step / 0.1 * k;
    const Double3 at = (0.1 + radius - 0.003) * Double3{std::sin(angle), 0, std::cos(angle)};
    const Double3 way = k == 0 ? Double3{} : at - last;
    last = at;
    const double felt = relief_friction(split.finer, slope, friction, way, body.contacts());
    const ContactBody::ToolInput ball{{Shape::sphere(radius), {at, {1, 0, 0, 0}}}, felt};
    REQUIRE(answered(body.step({&ball, 1}, {}, {any_budget}).status));
    const Double3 normal = unit(at), force = body.tools()[0].force;
    const double pressed = dot(force, normal);
    if (k > 150) {  // it slides as a whole
      least = std::min(least, norm(force - pressed * normal) / pressed);
      most = std::max(most, norm(force - pressed * normal) / pressed);
    }
  }
  MESSAGE("drag over pressure between ", least, " and ", most);
  CHECK(most > friction + 0.1);
  CHECK(least < friction - 0.1);
  CHECK(body.energy().generated <= 1e-3 * body.energy().dissipated);
}

}  // namespace
}  // namespace greenloop
