#include "runtime/bound_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/split_surface.hpp"

namespace greenloop {
namespace {

// points in and around a ball of 0.1 m, at most a tenth of that away from its surface
std::vector<Vec3> around_the_ball(std::size_t count) {
  std::mt19937 random(4);
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> height(-0.01, 0.01);
  std::vector<Vec3> places;
  while (places.size() < count) {
    const Double3 at = (0.1 + height(random)) * unit(Double3{any(random), any(random), any(random)});
    places.push_back({static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)});
  }
  return places;
}

class Bound {
 public:
  explicit Bound(std::span<const Vec3> vertex)
      : model({.levels = 4}), split(model, 3, {0, FinerSurface::Rule::midpoint}) {
    memory_ = AlignedBytes(BoundMesh::required(split.surface, vertex.size()));
    const auto created = BoundMesh::create(split.surface, vertex, {memory_.data(), memory_.size()});
    REQUIRE(created);
    mesh = created.mesh;
  }

  [[nodiscard]] std::vector<Vec4> normals(std::span<const Vec4> field) const {
    std::vector<Vec4> normal(split.surface.node_count(3));
    REQUIRE(split.surface.normals(3, field, normal));
    return normal;
  }
  [[nodiscard]] std::vector<Vec4> positions(std::span<const Vec4> field) const {
    std::vector<Vec4> position(mesh.vertex_count());
    REQUIRE(mesh.positions(field, normals(field), {}, position));
    return position;
  }
  // what moves every node of the surface from x to f(x)
  template <class Motion>
  [[nodiscard]] std::vector<Vec4> field(Motion f) const {
    std::vector<Vec4> u;
    for (const Vec4& at : split.positions(0)) {
      const Double3 way = f(exact(at)) - exact(at);
      u.push_back({static_cast<float>(way.x), static_cast<float>(way.y), static_cast<float>(way.z), 0});
    }
    return u;
  }

  TestModel model;
  SplitSurface split;
  BoundMesh mesh;

 private:
  AlignedBytes memory_;
};

double worst_distance(const std::vector<Vec4>& found, const std::vector<Vec3>& rest, auto motion) {
  double worst = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    worst = std::max(worst, norm(exact(found[i]) - motion(Double3{rest[i].x, rest[i].y, rest[i].z})));
  }
  return worst;
}

TEST_CASE("a bound mesh is where it was while the body is at rest, and turns with it as a whole") {
  const auto places = around_the_ball(500);
  const Bound bound(places);
  CHECK(worst_distance(bound.positions({}), places, [](const Double3& x) { return x; }) < 2e-8);
  const double c = std::cos(2), s = std::sin(2);
  const auto turned = [&](const Double3& x) { return Double3{c * x.x - s * x.z + 0.3, x.y - 0.1, s * x.x + c * x.z}; };
  CHECK(worst_distance(bound.positions(bound.field(turned)), places, turned) < 2e-7);
}

TEST_CASE("detail that stands out turns with a body that bends") {
  std::vector<Vec3> places;  // where the body turns more than it is strained
  for (const Vec3& place : around_the_ball(2000)) {
    if (std::abs(place.z) < 0.02) places.push_back(place);
  }
  const Bound bound(places);
  // plane sections stay plane: a bar along x that is bent to a circle of 0.5 m
  const auto bent = [](const Double3& x) {
    const double radius = 0.5, angle = x.x / radius;
    return Double3{(radius - x.z) * std::sin(angle), x.y, radius - (radius - x.z) * std::cos(angle)};
  };
  const auto field = bound.field(bent);
  const double error = worst_distance(bound.positions(field), places, bent);
  // the same displacement as the surface's nearest point
  std::vector<Vec4> moved;
  for (const Vec3& place : places) {
    const auto nearest = bound.split.surface.nearest_point(place);
    Double3 at{place.x, place.y, place.z};
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = bound.split.surface.triangle(3, nearest.triangle).node[k];
      at += double{nearest.weight[k]} * exact(field[node]);
    }
    moved.push_back({static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z), 0});
  }
  const double unturned = worst_distance(moved, places, bent);
  MESSAGE("vertices up to 10 mm off a ball of 100 mm that bends by 0.2 rad: off by ", 1e3 * error,
          " mm; if they did not turn, ", 1e3 * unturned, " mm");
  CHECK(unturned > 1e-3);
  CHECK(error < 0.5 * unturned);
}

TEST_CASE("vertices over what is not seen are left as they were") {
  const auto places = around_the_ball(300);
  const Bound bound(places);
  const auto field = bound.field([](const Double3& x) { return 1.1 * x; });
  const auto all = bound.positions(field);
  std::vector<std::uint8_t> seen(bound.split.surface.triangle_count(1));
  for (std::size_t t = 0; t < seen.size(); t += 3) seen[t] = 1;
  std::vector<Vec4> some(all.size(), Vec4{7, 7, 7, 7});
  REQUIRE(bound.mesh.positions(field, bound.normals(field), seen, some));
  std::size_t written = 0;
  for (std::uint32_t i = 0; i < some.size(); ++i) {
    const bool is_seen = seen[bound.mesh.triangle(i) >> 4] == 1;
    CHECK(some[i].w == (is_seen ? 0 : 7));
    CHECK(some[i].x == (is_seen ? all[i].x : 7));
    written += is_seen ? 1 : 0;
  }
  CHECK(written > 50);
  CHECK(written < 200);
}

TEST_CASE("what cannot be bound, and wrong sizes, are refused") {
  auto places = around_the_ball(20);
  const Bound bound(places);
  const std::size_t need = BoundMesh::required(bound.split.surface, places.size());
  AlignedBytes memory(need + 64);
  CHECK(BoundMesh::create(bound.split.surface, places, {memory.data(), need - 1}).missing == 1);
  CHECK(BoundMesh::create(bound.split.surface, places, {memory.data() + 4, need}).error ==
        BoundMesh::Error::memory_misaligned);
  CHECK(BoundMesh::required(bound.split.surface, std::size_t{1} << 30) == 0);
  places[13].y = std::nanf("");
  const auto refused = BoundMesh::create(bound.split.surface, places, {memory.data(), need});
  CHECK(refused.error == BoundMesh::Error::bad_vertex);
  CHECK(refused.at == 13);
  std::vector<Vec4> position(20, Vec4{7, 7, 7, 7});
  const auto normal = bound.normals({});
  const std::vector<std::uint8_t> seen(5, 1);
  CHECK(!bound.mesh.positions({}, normal, {}, {position.data(), 19}));
  CHECK(!bound.mesh.positions({}, {normal.data(), 5}, {}, position));
  CHECK(!bound.mesh.positions({normal.data(), 5}, normal, {}, position));
  CHECK(!bound.mesh.positions({}, normal, seen, position));
  CHECK(position[0].w == 7);
}

}  // namespace
}  // namespace greenloop
