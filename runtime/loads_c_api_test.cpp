#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "runtime/greenloop.h"
#include "runtime/stiffness.hpp"
#include "runtime/surface.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wrench.hpp"

namespace greenloop {
namespace {

constexpr SyntheticOptions with_loads{.levels = 3, .gravity = true, .pressures = 2};
constexpr Elastostatic::Limits limits{.max_contacts = 4,
                                      .cached_factors = 2,
                                      .max_forces = 40,
                                      .model_loads = true,
                                      .mixed_contacts = true,
                                      .max_points = 2};

// a body in C beside one in C++
struct Both {
  Both() : model(with_loads), cpp(model, limits), bytes(encode(synthetic_model(with_loads))) {
    REQUIRE(greenloop_open(bytes.data(), bytes.size(), &c_model).rule == GREENLOOP_RULE_OK);
    greenloop_elastostatic_limits same{};
    same.max_contacts = limits.max_contacts;
    same.cached_factors = limits.cached_factors;
    same.max_forces = limits.max_forces;
    same.model_loads = 1;
    same.max_points = limits.max_points;
    same.mixed_contacts = 1;
    need = greenloop_elastostatic_required(&c_model, same);
    arena = AlignedBytes(need.bytes);
    field = AlignedBytes(std::size_t{16} * greenloop_node_count(&c_model));
    c = greenloop_elastostatic_create(&c_model, same, arena.data(), arena.size()).body;
    REQUIRE(c != nullptr);
  }
  TestModel model;
  TestBody cpp;
  AlignedBytes bytes, arena, field;
  greenloop_model c_model{};
  greenloop_elastostatic_requirement need{};
  greenloop_elastostatic* c = nullptr;
};

template <class A, class B>
bool same_bytes(const A& a, const B& b) {
  using Words = std::array<std::uint32_t, sizeof(A) / sizeof(std::uint32_t)>;
  return std::bit_cast<Words>(a) == std::bit_cast<Words>(b);
}

TEST_CASE("a loaded step, and what is asked after it, are the same through C, bit for bit") {
  Both both;
  CHECK(both.need.bytes == both.cpp.requirement().bytes);
  CHECK(both.need.least_work == both.cpp.requirement().least_work);
  CHECK(both.need.selected_work == both.cpp.requirement().selected_work);
  CHECK(greenloop_has_gravity(&both.c_model) == 1);
  CHECK(greenloop_pressure_count(&both.c_model) == 2);
  const auto nodes = both.model.touchable();
  const std::uint32_t count = greenloop_node_count(&both.c_model);
  AlignedBytes memory(Surface::required(both.model.model(), 2).bytes);
  const auto created = greenloop_surface_create(&both.c_model, 2, memory.data(), memory.size());
  REQUIRE(created.error == GREENLOOP_SURFACE_OK);
  const greenloop_vertex point{{nodes[3], nodes[8], nodes[9]}, {0.5F, 0.25F, 0.25F}};
  std::uint32_t masked[40];
  float weight[40];
  const greenloop_mask mask = greenloop_make_mask(created.surface, 2, &point, 0.06F, masked, weight, 40);
  REQUIRE(mask.nodes > 1);
  std::vector<std::uint32_t> cpp_masked(40);
  std::vector<float> cpp_weight(40);
  const MeshPoint same_point{{nodes[3], nodes[8], nodes[9]}, {0.5F, 0.25F, 0.25F}};
  AlignedBytes same_memory(memory.size());
  const auto surface = Surface::create(both.model.model(), 2, {same_memory.data(), same_memory.size()});
  REQUIRE(surface);
  const Mask same_mask = make_mask(surface.surface, 2, same_point, 0.06F, cpp_masked, cpp_weight);
  REQUIRE(same_mask.node.size() == mask.nodes);
  CHECK(std::equal(same_mask.node.begin(), same_mask.node.end(), mask.node));
  CHECK(std::equal(same_mask.weight.begin(), same_mask.weight.end(), mask.weight));

  const greenloop_constraint constraints[] = {{nodes[20], {1e-3F, 0, 0}, GREENLOOP_HOLD},
                                              {0, {0, 1, 0}, GREENLOOP_PATTERN}};
  const std::vector<Constraint> same = {{nodes[20], {1e-3F, 0, 0}}, {0, {0, 1, 0}, Constraint::Kind::pattern}};
  const float pressure[] = {100, 200};
  const greenloop_loads loads{&mask, 1, {0, 0, -9.81F}, pressure, 2, 2, nullptr, 0};
  float force[6];
  const auto report = greenloop_elastostatic_step_loaded(both.c, constraints, 2, &loads, any_budget, force,
                                                         reinterpret_cast<float*>(both.field.data()), count);
  const Elastostatic::StepReport expected =
      both.cpp.step(same, {std::span(&same_mask, 1), {0, 0, -9.81F}, pressure, 2}, any_budget, true);
  CHECK(report.status == GREENLOOP_OK);
  CHECK(report.work == expected.work);
  CHECK(std::equal(both.cpp.force().begin(), both.cpp.force().end(), force));
  CHECK(std::memcmp(both.field.data(), both.cpp.field().data(), both.field.size()) == 0);

  Vec3 moved;
  float c_moved[3];
  CHECK(greenloop_elastostatic_displacements(both.c, &point, 1, c_moved) ==
        both.cpp.body().displacements({&same_point, 1}, {&moved, 1}));
  CHECK(same_bytes(moved, c_moved));
  float block[9], c_block[9];
  CHECK(greenloop_elastostatic_masked_compliance(both.c, nodes[3], &mask, c_block) ==
        both.cpp.body().masked_compliance(nodes[3], same_mask, block));
  CHECK(same_bytes(block, c_block));
  const greenloop_mask masks[] = {mask, mask, mask};
  const Mask same_masks[] = {same_mask, same_mask, same_mask};
  CHECK(greenloop_elastostatic_stiffness(both.c, &point, masks, 50, 1, c_block) ==
        both.cpp.body().stiffness(same_point, same_masks, 50, true, block));
  CHECK(same_bytes(block, c_block));
  CHECK(stiffness_norm(block) > 0);
}

TEST_CASE("mixed contacts are the same through C, bit for bit") {
  Both both;
  const auto nodes = both.model.touchable();
  const std::uint32_t masked[] = {nodes[4], nodes[9], nodes[17]};
  const float weight[] = {0.5F, 0.25F, 0.25F}, up[] = {0, 0, 1};
  const greenloop_mask mask{masked, 3, weight, 3};
  const Mask same_mask{masked, weight};
  float part[9];
  std::vector<Vec3> same_part(3);
  greenloop_directed_mask directed[] = {greenloop_direct_mask(&mask, up, part, 3), {}};
  const DirectedMask same_directed = direct_mask(same_mask, {0, 0, 1}, same_part);
  REQUIRE(directed[0].parts == 3);
  CHECK(std::memcmp(part, same_part.data(), sizeof part) == 0);
  float torque[9];
  std::vector<Vec3> same_torque(3);
  directed[1] = greenloop_make_torque_mask(&both.c_model, &mask, up, torque, 3);
  REQUIRE(make_torque_mask(both.model.model(), same_mask, {0, 0, 1}, same_torque).part.size() == directed[1].parts);
  CHECK(std::memcmp(torque, same_torque.data(), sizeof torque) == 0);

  const greenloop_constraint constraints[] = {{nodes[20], {1e-3F, 0, 0}, GREENLOOP_HOLD},
                                              {0, {-1e-3F, 0, 0}, GREENLOOP_NORMAL},
                                              {1, {1e-3F, 0, 0}, GREENLOOP_ALONG}};
  const std::vector<Constraint> same = {{nodes[20], {1e-3F, 0, 0}},
                                        {0, {-1e-3F, 0, 0}, Constraint::Kind::normal},
                                        {1, {1e-3F, 0, 0}, Constraint::Kind::along}};
  greenloop_loads loads{};
  loads.directed_mask = directed;
  loads.directed_masks = 2;
  Elastostatic::Loads same_loads;
  const DirectedMask both_directed[] = {same_directed, {masked, same_torque}};
  same_loads.directed = both_directed;
  float force[9];
  const auto report = greenloop_elastostatic_step_loaded(both.c, constraints, 3, &loads, any_budget, force, nullptr, 0);
  const Elastostatic::StepReport expected = both.cpp.step(same, same_loads, any_budget, false);
  CHECK(report.status == GREENLOOP_OK);
  CHECK(report.work == expected.work);
  CHECK(std::equal(both.cpp.force().begin(), both.cpp.force().end(), force));
  CHECK(force[3] < 0);
  CHECK(force[6] == 1e-3F);
}

TEST_CASE("a stiffness of 0 is the model's own; wrenches are those of C++") {
  Both both;
  const greenloop_constraint held{both.model.touchable()[5], {1e-3F, 0, 0}, GREENLOOP_HOLD};
  float own[3], plain[3];
  const greenloop_loads none{};
  greenloop_elastostatic_step_loaded(both.c, &held, 1, &none, any_budget, own, nullptr, 0);
  greenloop_elastostatic_step(both.c, &held, 1, any_budget, plain, nullptr, 0);
  CHECK(same_bytes(own, plain));
  const float position[] = {1, 2, 3}, force[] = {4, 5, 6}, about[] = {0, 1, 0};
  const greenloop_wrench wrench = greenloop_total_wrench(position, force, 1, about);
  const Vec3 at{1, 2, 3}, by{4, 5, 6};
  CHECK(same_bytes(wrench, total_wrench({&at, 1}, {&by, 1}, {0, 1, 0})));
}

}  // namespace
}  // namespace greenloop
