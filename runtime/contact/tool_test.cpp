#include "runtime/contact/tool.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

using Error = ConvexPolyhedron::Error;
using Face = ConvexPolyhedron::Face;

/// A polyhedron in memory of its own.
struct Solid {
  Solid(std::vector<Double3> vertices, std::vector<Face> triangles)
      : vertex(std::move(vertices)),
        face(std::move(triangles)),
        memory(std::max<std::size_t>(64, ConvexPolyhedron::required(vertex.size(), face.size()))),
        created(ConvexPolyhedron::create(vertex, face, {memory.data(), memory.size()})) {}
  std::vector<Double3> vertex;
  std::vector<Face> face;
  AlignedBytes memory;
  ConvexPolyhedron::Created created;
};

std::vector<Double3> corners(const Double3& half, const Double3& centre = {}) {
  std::vector<Double3> vertex;
  vertex.reserve(8);
  for (int i = 0; i < 8; ++i) {
    vertex.push_back(centre + Double3{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
  }
  return vertex;
}

const std::vector<Face> box_faces{{{0, 2, 1}}, {{1, 2, 3}}, {{4, 5, 6}}, {{5, 7, 6}}, {{0, 1, 4}}, {{1, 5, 4}},
                                  {{2, 6, 3}}, {{3, 6, 7}}, {{0, 4, 2}}, {{2, 4, 6}}, {{1, 3, 5}}, {{3, 7, 5}}};
constexpr Double3 half{0.03, 0.01, 0.02};

Error refused(std::vector<Double3> vertex, std::vector<Face> face) {
  return Solid(std::move(vertex), std::move(face)).created.error;
}

Double3 random_vector(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> anywhere(-size, size);
  const double x = anywhere(random), y = anywhere(random), z = anywhere(random);
  return {x, y, z};
}

TEST_CASE("a pose turns and moves as its quaternion says, and back") {
  const double s = std::sqrt(0.5);
  const Placed placed = place({{1, 2, 3}, {s, 0, 0, s}});  // a quarter turn about z
  REQUIRE(placed);
  const Double3 x = placed.placement.to_model({0.1, 0, 0.2});
  CHECK(norm(x - Double3{1, 2.1, 3.2}) < 1e-15);
  CHECK(norm(placed.placement.to_tool(x) - Double3{0.1, 0, 0.2}) < 1e-15);
}

TEST_CASE("a quaternion that is nearly of unit length is brought to it, another one is refused") {
  const Placed exact = place({{}, {0.6, 0, 0.8, 0}}), near = place({{}, {0.603, 0, 0.804, 0}});
  REQUIRE(near);
  for (int k = 0; k < 3; ++k) {
    CHECK(norm(near.placement.axis[k] - exact.placement.axis[k]) < 1e-15);
    CHECK(norm(near.placement.axis[k]) == doctest::Approx(1).epsilon(1e-15));
  }
  CHECK(place({{}, {0.62, 0, 0.8, 0}}).error == PoseError::not_unit);
  CHECK(place({{}, {0, 0, 0, 0}}).error == PoseError::not_unit);
  CHECK(place({{}, {1e200, 0, 0, 0}}).error == PoseError::not_unit);
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN(), endless = HUGE_VAL;
  CHECK(place({{0, nothing, 0}, {1, 0, 0, 0}}).error == PoseError::not_finite);
  CHECK(place({{0, 0, -endless}, {1, 0, 0, 0}}).error == PoseError::not_finite);
  CHECK(place({{}, {nothing, 0, 0, 0}}).error == PoseError::not_finite);
  CHECK(place({{}, {endless, 0, 0, 0}}).error == PoseError::not_finite);
  CHECK(place({{1.01e6, 0, 0}, {1, 0, 0, 0}}).error == PoseError::too_far);
}

TEST_CASE("polyhedra that are not closed, convex and outward are refused by name") {
  const auto vertex = corners(half);
  CHECK(refused(vertex, box_faces) == Error::none);
  CHECK(refused({vertex[0], vertex[1], vertex[2]}, box_faces) == Error::bad_count);
  CHECK(refused(std::vector<Double3>(ConvexPolyhedron::max_vertices + 1), box_faces) == Error::bad_count);
  CHECK(refused(vertex, std::vector<Face>(ConvexPolyhedron::max_faces + 1)) == Error::bad_count);
  CHECK(refused({}, {}) == Error::bad_count);
  auto changed = vertex;
  changed[5].y = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(changed, box_faces) == Error::not_finite);
  changed[5].y = 1e300;
  CHECK(refused(changed, box_faces) == Error::not_finite);
  auto faces = box_faces;
  faces[3].vertex[1] = 8;
  CHECK(refused(vertex, faces) == Error::bad_index);
  faces[3].vertex[1] = 5;
  CHECK(refused(vertex, faces) == Error::flat_face);
  faces = box_faces;
  faces.pop_back();
  CHECK(refused(vertex, faces) == Error::not_closed);
  faces = box_faces;
  std::swap(faces[7].vertex[0], faces[7].vertex[1]);
  CHECK(refused(vertex, faces) == Error::not_closed);
  faces = box_faces;
  for (Face& f : faces) std::swap(f.vertex[0], f.vertex[1]);
  CHECK(refused(vertex, faces) == Error::inward);
  changed = vertex;
  changed[7] = 0.1 * vertex[7];
  const Solid dented(changed, box_faces);
  CHECK(dented.created.error == Error::not_convex);
  CHECK(dented.created.at == 3);
}

TEST_CASE("a polyhedron says what memory it lacks") {
  const auto vertex = corners(half);
  const std::size_t bytes = ConvexPolyhedron::required(8, 12);
  AlignedBytes memory(bytes + 64);
  const auto small = ConvexPolyhedron::create(vertex, box_faces, {memory.data(), bytes - 1});
  CHECK(small.error == Error::memory_too_small);
  CHECK(small.missing == 1);
  const auto crooked = ConvexPolyhedron::create(vertex, box_faces, {memory.data() + 8, bytes});
  CHECK(crooked.error == Error::memory_misaligned);
}

TEST_CASE("a polyhedron of a box's corners is the box, wherever one asks") {
  const Solid solid(corners(half), box_faces);
  REQUIRE(solid.created);
  const Shape box = Shape::box(half), polyhedron = Shape::polyhedron(solid.created.polyhedron);
  std::mt19937_64 random(5);
  for (int i = 0; i < 20000; ++i) {
    const Double3 at = random_vector(random, i % 2 == 0 ? 0.05 : 0.02);
    const SignedDistance a = box.distance(at), b = polyhedron.distance(at);
    REQUIRE(a.distance == doctest::Approx(b.distance).epsilon(1e-12));
    REQUIRE(norm(a.normal - b.normal) < 1e-9);
  }
}

std::vector<std::pair<std::string, Shape>> all_shapes(const Solid& solid) {
  return {{"point", Shape()},
          {"sphere", Shape::sphere(0.02)},
          {"capsule", Shape::capsule(0.01, 0.03)},
          {"box", Shape::box(half)},
          {"plane", Shape::plane()},
          {"polyhedron", Shape::polyhedron(solid.created.polyhedron)}};
}

// a tetrahedron: no symmetry hides a mistake
Solid wedge() {
  return {{{-0.02, -0.01, -0.01}, {0.03, -0.01, 0}, {0, 0.03, -0.01}, {0, 0, 0.02}},
          {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{2, 0, 3}}}};
}

TEST_CASE("distances: where the normal leads is the surface, and no direction leaves the shape sooner") {
  const Solid solid = wedge();
  REQUIRE(solid.created);
  std::mt19937_64 random(6);
  for (const auto& some : all_shapes(solid)) {
    const Shape& shape = some.second;
    CAPTURE(some.first);
    for (int i = 0; i < 2000; ++i) {
      const Double3 at = random_vector(random, 0.05);
      const SignedDistance d = shape.distance(at);
      REQUIRE(norm(d.normal) == doctest::Approx(1).epsilon(1e-12));
      const SignedDistance on = shape.distance(at - d.distance * d.normal);
      REQUIRE(std::abs(on.distance) < 1e-15);
      // the distance changes by no more than the way, so nothing nearer is on the surface
      const Double3 other = at + random_vector(random, 0.02);
      REQUIRE(std::abs(shape.distance(other).distance - d.distance) <= norm(other - at) * (1 + 1e-12));
      REQUIRE(norm(at) <= d.distance + shape.bounding_radius() + 1e-15);
    }
  }
}

TEST_CASE("supports: no point of the shape is farther along the direction") {
  const Solid solid = wedge();
  REQUIRE(solid.created);
  std::mt19937_64 random(7);
  for (const auto& some : all_shapes(solid)) {
    const Shape& shape = some.second;
    if (shape.kind() == Shape::Kind::plane) continue;
    CAPTURE(some.first);
    for (int i = 0; i < 500; ++i) {
      const Double3 direction = unit(random_vector(random, 1)), farthest = shape.support(direction);
      REQUIRE(std::abs(shape.distance(farthest).distance) < 1e-15);
      const Double3 at = random_vector(random, 0.05);
      const SignedDistance d = shape.distance(at);
      const Double3 inside = d.distance > 0 ? at - d.distance * d.normal : at;
      REQUIRE(dot(inside, direction) <= dot(farthest, direction) + 1e-15);
    }
  }
  CHECK(Shape::plane().support({0, 0, 1}) == Double3{0, 0, 0});
  CHECK(Shape::plane().support({1, 0, 0}).x == HUGE_VAL);
  CHECK(Shape::plane().support({0, 0, -1}).z == -HUGE_VAL);
}

TEST_CASE("shapes have points to follow, on their surface or their radius inside") {
  const Solid solid = wedge();
  REQUIRE(solid.created);
  const std::array<std::uint32_t, 6> expected{1, 1, 7, 8, 0, 4};
  std::size_t at = 0;
  for (const auto& some : all_shapes(solid)) {
    const Shape& shape = some.second;
    CAPTURE(some.first);
    REQUIRE(shape.check() == Shape::Error::none);
    CHECK(shape.point_count() == expected[at++]);
    for (std::uint32_t i = 0; i < shape.point_count(); ++i) {
      CHECK(std::abs(shape.distance(shape.point(i)).distance + shape.point_radius()) < 1e-15);
    }
  }
  CHECK(Shape::capsule(0.01, 0).point_count() == 1);
  CHECK(Shape::capsule(0.01, 0).point(0) == Double3{});
  const Shape rod = Shape::capsule(1e-9, 1);
  CHECK(rod.point_count() == Shape::max_axis_points);
  CHECK(rod.point(0).z == -1);
  CHECK(rod.point(7).z == 1);
}

TEST_CASE("shapes of no size are refused") {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nothing, HUGE_VAL, 1e7}) {
    CHECK(Shape::sphere(bad).check() == Shape::Error::bad_size);
    CHECK(Shape::capsule(bad, 1).check() == Shape::Error::bad_size);
    CHECK(Shape::box({1, bad, 1}).check() == Shape::Error::bad_size);
    if (bad != 0) CHECK(Shape::capsule(1, bad).check() == Shape::Error::bad_size);
  }
  CHECK(Shape::polyhedron({}).check() == Shape::Error::no_polyhedron);
}

}  // namespace
}  // namespace greenloop
