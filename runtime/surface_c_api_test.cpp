#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "runtime/greenloop.h"
#include "runtime/surface.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// the same surface made through C and through C++
class Both {
 public:
  Both() : bytes_(encode(synthetic_model({.levels = 3}))) {
    REQUIRE(greenloop_open(bytes_.data(), bytes_.size(), &model).rule == GREENLOOP_RULE_OK);
    const TestModel same(bytes_.span());
    const std::size_t need = greenloop_surface_required(&model, 2);
    CHECK(need == Surface::required(same.model(), 2).bytes);
    memory = AlignedBytes(need);
    const auto made = greenloop_surface_create(&model, 2, memory.data(), memory.size());
    REQUIRE(made.error == GREENLOOP_SURFACE_OK);
    c = made.surface;
    memory_ = AlignedBytes(need);
    cpp = Surface::create(same.model(), 2, {memory_.data(), memory_.size()}).surface;
  }

  greenloop_model model{};
  greenloop_surface* c = nullptr;
  Surface cpp;
  AlignedBytes memory;

 private:
  AlignedBytes bytes_;
  AlignedBytes memory_;
};

TEST_CASE("surface: C and C++ give the same triangles, normals and areas") {
  const Both both;
  for (std::uint32_t level = 0; level < 3; ++level) {
    const std::uint32_t triangles = greenloop_surface_triangle_count(both.c, level);
    const std::uint32_t nodes = greenloop_surface_node_count(both.c, level);
    REQUIRE(triangles == both.cpp.triangle_count(level));
    REQUIRE(nodes == both.cpp.node_count(level));
    std::vector<greenloop_triangle> triangle(triangles);
    std::vector<Surface::Triangle> same_triangle(triangles);
    REQUIRE(greenloop_surface_triangles(both.c, level, triangle.data(), triangles) == 1);
    REQUIRE(both.cpp.triangles(level, same_triangle));
    CHECK(std::memcmp(triangle.data(), same_triangle.data(), sizeof triangle[0] * triangles) == 0);
    std::vector<Vec4> normal(nodes), same_normal(nodes);
    const std::vector<Vec4> moved(nodes, {1e-3F, 2e-3F, 0, 0});
    auto* const floats = as_floats(normal).data();
    REQUIRE(greenloop_surface_normals(both.c, level, &moved[0].x, floats, nodes) == 1);
    REQUIRE(both.cpp.normals(level, moved, same_normal));
    CHECK(std::memcmp(normal.data(), same_normal.data(), sizeof normal[0] * nodes) == 0);
    std::vector<float> area(nodes), same_area(nodes);
    REQUIRE(greenloop_surface_areas(both.c, level, nullptr, area.data(), nodes) == 1);
    REQUIRE(both.cpp.areas(level, {}, same_area));
    CHECK(area == same_area);
  }
}

TEST_CASE("surface: C and C++ find the same node and point") {
  const Both both;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<float> anywhere(-0.2F, 0.2F);
  for (int i = 0; i < 200; ++i) {
    const float position[3] = {anywhere(random), anywhere(random), anywhere(random)};
    const Vec3 same{position[0], position[1], position[2]};
    const auto node = greenloop_surface_nearest_node(both.c, position, GREENLOOP_NODE_TOUCHABLE);
    CHECK(node.node == both.cpp.nearest_node(same, layout::node_touchable).node);
    CHECK(node.squared_distance == both.cpp.nearest_node(same, layout::node_touchable).squared_distance);
    CHECK(greenloop_is_touchable(&both.model, node.node) == 1);
    const auto point = greenloop_surface_nearest_point(both.c, position);
    const auto same_point = both.cpp.nearest_point(same);
    CHECK(point.triangle == same_point.triangle);
    CHECK(std::equal(point.weight, point.weight + 3, same_point.weight));
    CHECK(point.squared_distance == same_point.squared_distance);
  }
}

TEST_CASE("surface: what does not fit is refused in C too") {
  Both both;
  alignas(16) float floats[8] = {7};
  const std::uint32_t nodes = greenloop_surface_node_count(both.c, 0);
  std::vector<Vec4> normal(nodes + 1);
  float* const misaligned = as_floats(normal).data() + 1;
  CHECK(greenloop_surface_normals(both.c, 0, nullptr, misaligned, nodes) == 0);
  CHECK(greenloop_surface_normals(both.c, 0, misaligned, as_floats(normal).data(), nodes) == 0);
  CHECK(greenloop_surface_areas(both.c, 0, nullptr, floats, nodes + 1) == 0);
  CHECK(greenloop_surface_triangles(both.c, 3, nullptr, 0) == 0);
  CHECK(floats[0] == 7);
  CHECK(greenloop_surface_node_count(both.c, 3) == 0);
  CHECK(greenloop_surface_required(&both.model, 3) == 0);
  CHECK(greenloop_surface_create(&both.model, 3, both.memory.data(), both.memory.size()).error ==
        GREENLOOP_SURFACE_BAD_LEVEL);
  const auto small = greenloop_surface_create(&both.model, 2, both.memory.data(), both.memory.size() - 64);
  CHECK(small.error == GREENLOOP_SURFACE_MEMORY_TOO_SMALL);
  CHECK(small.missing == 64);
  CHECK(small.surface == nullptr);
}

TEST_CASE("a vertex map is told in C too") {
  const AlignedBytes bytes(encode(synthetic_model({.levels = 2, .vertices = 9})));
  greenloop_model model;
  REQUIRE(greenloop_open(bytes.data(), bytes.size(), &model).rule == GREENLOOP_RULE_OK);
  const auto opened = Model::open(bytes.span());
  REQUIRE(greenloop_vertex_count(&model) == 9);
  greenloop_vertex where{};
  for (std::size_t i = 0; i < 9; ++i) {
    REQUIRE(greenloop_vertex_on_surface(&model, i, &where) == 1);
    const layout::VertexRecord& same = opened.model.view().vertices[i];
    CHECK(std::equal(where.node, where.node + 3, same.node));
    CHECK(std::equal(where.weight, where.weight + 3, same.weight));
  }
  CHECK(greenloop_vertex_on_surface(&model, 9, &where) == 0);
  const Both without;
  CHECK(greenloop_vertex_count(&without.model) == 0);
}

TEST_CASE("surface: every error has a text of its own") {
  std::set<std::string> texts;
  for (int error = GREENLOOP_SURFACE_OK; error <= GREENLOOP_SURFACE_MEMORY_MISALIGNED; ++error) {
    texts.insert(greenloop_surface_error_text(static_cast<greenloop_surface_error>(error)));
  }
  CHECK(texts.size() == GREENLOOP_SURFACE_MEMORY_MISALIGNED + 1);
  CHECK(texts.count("unknown") == 0);
  CHECK(std::string(greenloop_surface_error_text(static_cast<greenloop_surface_error>(6))) == "unknown");
}

}  // namespace
}  // namespace greenloop
