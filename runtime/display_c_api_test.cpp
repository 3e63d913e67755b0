#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "runtime/bound_mesh.hpp"
#include "runtime/greenloop_display.h"
#include "runtime/look.hpp"
#include "runtime/relief.hpp"
#include "runtime/testing/split_surface.hpp"

namespace greenloop {
namespace {

bool equal(const std::vector<Vec4>& a, const std::vector<Vec4>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), sizeof a[0] * a.size()) == 0;
}

// the same surface in C
class InC {
 public:
  InC() : bytes_(encode(synthetic_model({.levels = 3}))) {
    REQUIRE(greenloop_open(bytes_.data(), bytes_.size(), &model_).rule == GREENLOOP_RULE_OK);
    surface_memory_ = AlignedBytes(greenloop_surface_required(&model_, 2));
    surface = greenloop_surface_create(&model_, 2, surface_memory_.data(), surface_memory_.size()).surface;
    REQUIRE(surface != nullptr);
    memory = AlignedBytes(greenloop_finer_surface_required(surface, 1, GREENLOOP_FINER_LOOP));
    finer = greenloop_finer_surface_create(surface, 1, GREENLOOP_FINER_LOOP, memory.data(), memory.size()).surface;
    REQUIRE(finer != nullptr);
  }

  greenloop_surface* surface = nullptr;
  greenloop_finer_surface* finer = nullptr;
  AlignedBytes memory;

 private:
  AlignedBytes bytes_, surface_memory_;
  greenloop_model model_{};
};

TEST_CASE("display: C and C++ give the same pictures") {
  const InC c;
  const TestModel model({.levels = 3});
  const SplitSurface cpp(model, 2, {1, FinerSurface::Rule::loop});
  const std::uint32_t nodes = cpp.finer.vertex_count(0), vertices = cpp.finer.vertex_count(1);
  REQUIRE(greenloop_finer_surface_vertex_count(c.finer, 1) == vertices);
  REQUIRE(greenloop_finer_surface_triangle_count(c.finer, 1) == cpp.finer.triangle_count(1));
  for (std::uint32_t t = 0; t < cpp.finer.triangle_count(1); ++t) {
    const auto triangle = greenloop_finer_surface_triangle(c.finer, 1, t);
    CHECK(std::equal(triangle.node, triangle.node + 3, cpp.finer.triangle(1, t).node));
  }
  std::vector<Vec4> field(nodes, Vec4{1e-3F, 0, 2e-3F, 0});
  field[3] = {};
  const greenloop_look look = {{0, 0, 1}, {0, 0, -1}, 0.5F, 0.01F, 0.25F};
  std::vector<std::uint8_t> seen(cpp.surface.triangle_count(1)), same_seen(seen.size());
  const auto flags = static_cast<std::uint32_t>(seen.size());
  const greenloop_seen found = greenloop_look_at(c.surface, &field[0].x, nodes, look, seen.data(), flags);
  const Seen same = look_at(cpp.surface, field, {{0, 0, 1}, {0, 0, -1}, 0.5F, 0.01F, 0.25F}, same_seen);
  CHECK(found.triangles == same.triangles);
  CHECK(found.halvings == same.halvings);
  CHECK(seen == same_seen);
  std::vector<Vec4> position(vertices), same_position(vertices), normal(vertices), same_normal(vertices);
  REQUIRE(greenloop_finer_surface_positions(c.finer, 1, &field[0].x, nodes, &position[0].x, vertices) == 1);
  REQUIRE(cpp.finer.positions(1, field, same_position));
  CHECK(equal(position, same_position));
  REQUIRE(greenloop_finer_surface_normals(c.finer, 1, &position[0].x, &normal[0].x, vertices) == 1);
  REQUIRE(cpp.finer.normals(1, position, same_normal));
  CHECK(equal(normal, same_normal));
}

TEST_CASE("display: C and C++ bind the same mesh") {
  const InC c;
  const TestModel model({.levels = 3});
  const SplitSurface cpp(model, 2, {0, FinerSurface::Rule::midpoint});
  const std::vector<Vec3> vertex{{0.11F, 0, 0}, {0, 0.09F, 0.02F}, {0.05F, 0.05F, 0.08F}};
  AlignedBytes memory(greenloop_bound_mesh_required(c.surface, 3)), same_memory(memory.size());
  const auto made = greenloop_bound_mesh_create(c.surface, &vertex[0].x, 3, memory.data(), memory.size());
  REQUIRE(made.error == GREENLOOP_BOUND_OK);
  CHECK(greenloop_bound_mesh_vertex_count(made.mesh) == 3);
  const auto same = BoundMesh::create(cpp.surface, vertex, {same_memory.data(), same_memory.size()});
  const std::uint32_t nodes = cpp.surface.node_count(2);
  std::vector<Vec4> field(nodes, Vec4{0, 1e-3F, 0, 0}), normal(nodes), position(3), same_position(3);
  REQUIRE(cpp.surface.normals(2, field, normal));
  REQUIRE(greenloop_bound_mesh_positions(made.mesh, &field[0].x, &normal[0].x, nodes, nullptr, 0, &position[0].x, 3));
  REQUIRE(same.mesh.positions(field, normal, {}, same_position));
  CHECK(equal(position, same_position));
}

TEST_CASE("display: C and C++ feel the same relief") {
  const InC c;
  const TestModel model({.levels = 3});
  const SplitSurface cpp(model, 2, {1, FinerSurface::Rule::loop});
  const std::uint32_t vertices = cpp.finer.vertex_count(1);
  std::vector<Vec4> normal(vertices);
  REQUIRE(cpp.finer.normals(1, cpp.positions(1), normal));
  const std::vector<Vec3> detail(vertices, Vec3{0.2F, 0.3F, 1});
  std::vector<Vec3> slope(vertices), same_slope(vertices);
  REQUIRE(greenloop_relief_slopes(&normal[0].x, &detail[0].x, &slope[0].x, vertices) == 1);
  REQUIRE(relief_slopes(normal, detail, same_slope));
  CHECK(std::memcmp(slope.data(), same_slope.data(), sizeof slope[0] * vertices) == 0);
  greenloop_touch touch{};
  touch.node[0] = 0;
  touch.node[1] = 1;
  touch.node[2] = GREENLOOP_NONE;
  touch.weight[0] = touch.weight[1] = 0.5;
  touch.normal[2] = -1;
  touch.force[2] = -2;
  ContactBody::Contact contact;
  std::memcpy(static_cast<void*>(&contact), &touch, sizeof touch);
  const double way[3] = {1e-4, 2e-4, 0};
  const double felt = greenloop_relief_friction(c.finer, &slope[0].x, vertices, 0.4, way, &touch, 1);
  CHECK(felt != 0.4);
  CHECK(felt == relief_friction(cpp.finer, slope, 0.4, {1e-4, 2e-4, 0}, {&contact, 1}));
}

TEST_CASE("display: what does not fit is refused in C too") {
  InC c;
  CHECK(greenloop_finer_surface_required(c.surface, 5, GREENLOOP_FINER_LOOP) == 0);
  const auto small = greenloop_finer_surface_create(c.surface, 1, GREENLOOP_FINER_LOOP, c.memory.data(), 64);
  CHECK(small.error == GREENLOOP_FINER_MEMORY_TOO_SMALL);
  CHECK(small.missing == small.requested - 64);
  CHECK(small.surface == nullptr);
  const std::uint32_t vertices = greenloop_finer_surface_vertex_count(c.finer, 1);
  std::vector<Vec4> position(vertices + 1);
  float* const misaligned = &position[0].y;
  CHECK(greenloop_finer_surface_positions(c.finer, 1, nullptr, 0, misaligned, vertices) == 0);
  CHECK(greenloop_finer_surface_positions(c.finer, 1, nullptr, 0, &position[0].x, 3) == 0);
  CHECK(greenloop_finer_surface_normals(c.finer, 1, misaligned, &position[0].x, vertices) == 0);
  const float nowhere[3] = {INFINITY, 0, 0};
  AlignedBytes memory(greenloop_bound_mesh_required(c.surface, 1));
  CHECK(greenloop_bound_mesh_create(c.surface, nowhere, 1, memory.data(), memory.size()).error ==
        GREENLOOP_BOUND_BAD_VERTEX);
}

TEST_CASE("display: every error has a text of its own") {
  std::set<std::string> texts;
  for (int error = GREENLOOP_FINER_OK; error <= GREENLOOP_FINER_MEMORY_MISALIGNED; ++error) {
    texts.insert(greenloop_finer_error_text(static_cast<greenloop_finer_error>(error)));
  }
  CHECK(texts.size() == GREENLOOP_FINER_MEMORY_MISALIGNED + 1);
  std::set<std::string> bound;
  for (int error = GREENLOOP_BOUND_OK; error <= GREENLOOP_BOUND_MEMORY_MISALIGNED; ++error) {
    bound.insert(greenloop_bound_error_text(static_cast<greenloop_bound_error>(error)));
  }
  CHECK(bound.size() == GREENLOOP_BOUND_MEMORY_MISALIGNED + 1);
  CHECK(texts.count("unknown") + bound.count("unknown") == 0);
}

}  // namespace
}  // namespace greenloop
