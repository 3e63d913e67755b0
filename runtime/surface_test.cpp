#include "runtime/surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "formats/mesh/model_surface.hpp"
#include "runtime/surface/closest_point.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

std::span<std::byte> all_of(AlignedBytes& memory) { return {memory.data(), memory.size()}; }

// a surface in memory of its own; the model's bytes are gone
class TestSurface {
 public:
  explicit TestSurface(const SyntheticOptions& options, std::uint32_t level) {
    const TestModel model(options);
    mesh = semi_regular_surface(model.view());
    memory_ = AlignedBytes(Surface::required(model.model(), level).bytes);
    const auto created = Surface::create(model.model(), level, all_of(memory_));
    REQUIRE(created);
    surface = created.surface;
    triangles.resize(surface.triangle_count(level));
    REQUIRE(surface.triangles(level, triangles));
    for (std::uint32_t q = 0; q < model.view().levels; ++q) {
      const LevelView& at = model.view().level[q];
      nodes.insert(nodes.end(), at.nodes, at.nodes + at.counts->node_count);
    }
    nodes.resize(surface.node_count(level));
  }

  [[nodiscard]] Double3 place(std::uint32_t node) const {
    const float* x = nodes[node].position;
    return {x[0], x[1], x[2]};
  }

  // what a search of every node and of every triangle finds
  [[nodiscard]] Surface::NearestNode nearest_node(Vec3 position, std::uint32_t flags) const {
    Surface::NearestNode best{layout::none, HUGE_VAL};
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
      const Double3 offset = place(node) - Double3{position.x, position.y, position.z};
      const double distance = dot(offset, offset);
      if ((nodes[node].flags & flags) == flags && distance < best.squared_distance) best = {node, distance};
    }
    return best;
  }

  [[nodiscard]] Surface::NearestPoint nearest_point(Vec3 position) const {
    const Double3 from{position.x, position.y, position.z};
    Surface::NearestPoint best{layout::none, {}, HUGE_VAL};
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const auto& [a, b, c] = triangles[t].node;
      const ClosestPoint point = closest_to_origin({place(a) - from, place(b) - from, place(c) - from});
      if (point.squared_distance < best.squared_distance) {
        const double* w = point.weight;
        best = {
            t, {static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2])}, point.squared_distance};
      }
    }
    return best;
  }

  void check_same(Vec3 position, std::uint32_t flags = 0) const {
    const auto node = surface.nearest_node(position, flags), expected = nearest_node(position, flags);
    REQUIRE(node.node == expected.node);
    CHECK(node.squared_distance == expected.squared_distance);
    const auto point = surface.nearest_point(position), same = nearest_point(position);
    REQUIRE(point.triangle == same.triangle);
    CHECK(std::equal(point.weight, point.weight + 3, same.weight));
    CHECK(point.squared_distance == same.squared_distance);
  }

  Surface surface;
  SemiRegularMesh mesh;
  std::vector<Surface::Triangle> triangles;  // of the surface's level
  std::vector<layout::NodeRecord> nodes;

 private:
  AlignedBytes memory_;
};

Vec3 random_vector(std::mt19937_64& random, float size) {
  std::uniform_real_distribution<float> anywhere(-size, size);
  const float x = anywhere(random), y = anywhere(random), z = anywhere(random);
  return {x, y, z};
}

TEST_CASE("surface: the triangles of every level are the refined mesh's, whatever level the surface has") {
  for (std::uint32_t own = 0; own < 4; ++own) {
    const TestSurface test({.levels = 4}, own);
    CHECK(test.surface.level() == own);
    for (std::uint32_t level = 0; level <= own; ++level) {
      const auto expected = triangles_of_level(test.mesh, static_cast<int>(level));
      CHECK(test.surface.node_count(level) == test.mesh.vertex_end[level]);
      REQUIRE(test.surface.triangle_count(level) == expected.size());
      std::vector<Surface::Triangle> triangles(expected.size());
      REQUIRE(test.surface.triangles(level, triangles));
      for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const auto alone = test.surface.triangle(level, t);
        for (std::size_t k = 0; k < 3; ++k) {
          REQUIRE(static_cast<int>(triangles[t].node[k]) == expected[t][k]);
          REQUIRE(alone.node[k] == triangles[t].node[k]);
        }
      }
    }
    CHECK(test.surface.node_count(own + 1) == 0);
    CHECK(test.surface.triangle_count(own + 1) == 0);
    std::vector<Surface::Triangle> too_few(test.triangles.size() - 1);
    CHECK(!test.surface.triangles(own, too_few));
    CHECK(!test.surface.triangles(own + 1, {}));
  }
}

TEST_CASE("surface: nearest node and point are those of a search of everything, inside, outside and on the surface") {
  for (const std::uint32_t level : {0U, 1U, 3U}) {
    const TestSurface test({.levels = 4, .touchable_above = 0.3}, level);
    std::mt19937_64 random(5);
    for (int i = 0; i < 500; ++i) {
      test.check_same(random_vector(random, 0.2F), i % 2 == 0 ? std::uint32_t{layout::node_touchable} : 0U);
    }
    for (int i = 0; i < 50; ++i) test.check_same(random_vector(random, 1e3F));
    for (int i = 0; i < 20; ++i) test.check_same(random_vector(random, 1e38F));
    for (std::uint32_t node = 0; node < test.nodes.size(); ++node) {
      const float* x = test.nodes[node].position;
      test.check_same({x[0], x[1], x[2]});
      CHECK(test.surface.nearest_node({x[0], x[1], x[2]}).node == node);
      CHECK(test.surface.nearest_point({x[0], x[1], x[2]}).squared_distance == 0);
    }
  }
}

TEST_CASE("surface: of equally near ones the first is taken") {
  const TestSurface test({.levels = 1, .coarsest_constraint_level = 0}, 0);
  CHECK(test.surface.nearest_node({0, 0, 0}).node == 0);
  CHECK(test.surface.nearest_point({0, 0, 0}).triangle == 0);
  test.check_same({0, 0, 0});
  // above a corner all the triangles around it are as near
  for (std::uint32_t node = 0; node < test.nodes.size(); ++node) {
    const float* x = test.nodes[node].position;
    const auto point = test.surface.nearest_point({2 * x[0], 2 * x[1], 2 * x[2]});
    std::uint32_t first = 0;
    const auto has = [&](const Surface::Triangle& t) { return std::find(t.node, t.node + 3, node) != t.node + 3; };
    while (!has(test.triangles[first])) ++first;
    CHECK(point.triangle == first);
  }
}

TEST_CASE("surface: positions that are not finite are near nothing, flags that no node has name none") {
  const TestSurface test({.levels = 2}, 1);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    for (const Vec3 position : {Vec3{bad, 0, 0}, Vec3{0, bad, 0}, Vec3{0, 0, bad}}) {
      CHECK(test.surface.nearest_node(position).node == layout::none);
      CHECK(test.surface.nearest_point(position).triangle == layout::none);
    }
  }
  CHECK(test.surface.nearest_node({0, 0, 0}, layout::node_touchable | layout::node_fixed).node == layout::none);
}

// the outward normals that the mesh's own triangles give, in double
std::vector<Double3> expected_normals(const TestSurface& test, std::uint32_t level, std::span<const Vec4> moved) {
  std::vector<Double3> normal(test.surface.node_count(level));
  for (const auto& corner : triangles_of_level(test.mesh, static_cast<int>(level))) {
    Double3 x[3];
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = test.place(static_cast<std::uint32_t>(corner[k]));
      if (!moved.empty()) x[k] = x[k] + Double3{moved[corner[k]].x, moved[corner[k]].y, moved[corner[k]].z};
    }
    for (const int node : corner) normal[node] = normal[node] + cross(x[1] - x[0], x[2] - x[0]);
  }
  for (Double3& sum : normal) sum = (1 / std::sqrt(dot(sum, sum))) * sum;
  return normal;
}

TEST_CASE("surface: normals point outwards, at rest and displaced, at every level") {
  const TestSurface test({.levels = 4}, 3);
  std::mt19937_64 random(6);
  std::vector<Vec4> moved(test.nodes.size());
  for (Vec4& u : moved) {
    const Vec3 by = random_vector(random, 0.01F);
    u = {by.x, by.y, by.z, 0};
  }
  for (std::uint32_t level = 0; level < 4; ++level) {
    std::vector<Vec4> normal(test.surface.node_count(level));
    for (const std::span<const Vec4> displacement : {std::span<const Vec4>(), std::span<const Vec4>(moved)}) {
      REQUIRE(test.surface.normals(level, displacement, normal));
      const auto expected = expected_normals(test, level, displacement);
      for (std::uint32_t node = 0; node < normal.size(); ++node) {
        const Double3 error = expected[node] - Double3{normal[node].x, normal[node].y, normal[node].z};
        CHECK(dot(error, error) < 1e-11);
        CHECK(normal[node].w == 0);
      }
      for (std::uint32_t node = 0; node < normal.size() && displacement.empty(); ++node) {
        const Double3 n{normal[node].x, normal[node].y, normal[node].z};
        CHECK(dot(n, test.place(node)) > 0.9 * std::sqrt(dot(test.place(node), test.place(node))));
      }
    }
  }
}

TEST_CASE("surface: a node's area is a third of its triangles', and grows with the square of the size") {
  const TestSurface test({.levels = 4}, 3);
  std::vector<Vec4> doubled;
  for (const auto& node : test.nodes) doubled.push_back({node.position[0], node.position[1], node.position[2], 0});
  std::vector<float> area(test.nodes.size()), larger(test.nodes.size());
  REQUIRE(test.surface.areas(3, {}, area));
  REQUIRE(test.surface.areas(3, doubled, larger));
  for (std::size_t node = 0; node < area.size(); ++node) {
    CHECK(area[node] == doctest::Approx(test.nodes[node].area).epsilon(1e-5));
    CHECK(larger[node] == doctest::Approx(4 * area[node]).epsilon(1e-6));
  }
  // a coarser level has fewer nodes with more each
  std::vector<float> coarse(test.surface.node_count(1));
  REQUIRE(test.surface.areas(1, {}, coarse));
  double sum = 0, finest = 0;
  for (const float part : coarse) sum += part;
  for (const float part : area) finest += part;
  CHECK(sum > 0.7 * finest);
  CHECK(sum < finest);
}

TEST_CASE("surface: buffers and levels that do not fit are refused, nothing is written") {
  const TestSurface test({.levels = 3}, 2);
  const std::size_t count = test.nodes.size();
  std::vector<Vec4> normal(count, {7, 7, 7, 7}), few(count - 1), more(count + 1);
  std::vector<float> area(count, 7);
  CHECK(!test.surface.normals(3, {}, normal));
  CHECK(!test.surface.normals(1, {}, normal));
  CHECK(!test.surface.normals(2, few, normal));
  CHECK(!test.surface.normals(2, {}, few));
  CHECK(!test.surface.areas(3, {}, area));
  CHECK(!test.surface.areas(2, few, area));
  CHECK(normal[0].x == 7);
  CHECK(area[0] == 7);
  CHECK(test.surface.normals(2, more, normal));
}

TEST_CASE("surface: memory, level and model are checked") {
  const TestModel model({.levels = 3});
  const std::size_t bytes = Surface::required(model.model(), 2).bytes;
  CHECK(Surface::required(model.model(), 3).bytes == 0);
  CHECK(Surface::required(model.model(), 1).bytes < bytes);
  AlignedBytes memory(bytes + 64);
  CHECK(Surface::create(model.model(), 3, all_of(memory)).error == Surface::Error::bad_level);
  const auto small = Surface::create(model.model(), 2, all_of(memory).first(bytes - 1));
  CHECK(small.error == Surface::Error::memory_too_small);
  CHECK(small.requested == bytes);
  CHECK(small.available == bytes - 1);
  CHECK(small.missing == 1);
  CHECK(Surface::create(model.model(), 2, all_of(memory).subspan(8, bytes)).error == Surface::Error::memory_misaligned);
  CHECK(Surface::create(model.model(), 2, all_of(memory).first(bytes)));
}

TEST_CASE("surface: a model with an edge that no node halves is refused") {
  ModelData data = synthetic_model({.levels = 3});
  auto& refinement = data.levels[2].refinement;
  // two nodes halve the same edge, so that none halves another
  refinement[1].parent[0] = refinement[0].parent[0];
  refinement[1].parent[1] = refinement[0].parent[1];
  const TestModel model(encode(data));
  AlignedBytes memory(Surface::required(model.model(), 2).bytes);
  CHECK(Surface::create(model.model(), 2, all_of(memory)).error == Surface::Error::unsupported_model);
  CHECK(Surface::create(model.model(), 1, all_of(memory)));
}

TEST_CASE("surface: the same answers in other memory, and those recorded") {
  const TestSurface one({.levels = 4}, 3), two({.levels = 4}, 3);
  std::mt19937_64 random(11);
  std::uint64_t hash = empty_hash;
  std::vector<Vec4> normal(one.nodes.size());
  REQUIRE(one.surface.normals(3, {}, normal));
  hash = hash_bytes(hash, std::as_bytes(std::span(normal)));
  for (int i = 0; i < 1000; ++i) {
    // whole numbers, so that no library's distribution matters
    const auto coordinate = [&] { return static_cast<float>(random() % 4001) * 1e-4F - 0.2F; };
    const float x = coordinate(), y = coordinate(), z = coordinate();
    const auto point = one.surface.nearest_point({x, y, z}), same = two.surface.nearest_point({x, y, z});
    REQUIRE(point.triangle == same.triangle);
    const auto node = one.surface.nearest_node({x, y, z});
    hash = hash_bytes(hash, std::as_bytes(std::span(&point.triangle, 1)));
    hash = hash_bytes(hash, std::as_bytes(std::span(point.weight)));
    hash = hash_bytes(hash, std::as_bytes(std::span(&point.squared_distance, 1)));
    hash = hash_bytes(hash, std::as_bytes(std::span(&node.node, 1)));
  }
  CHECK(hash == 0x2fc7f3b1ba3ebac6);
}

}  // namespace
}  // namespace greenloop
