#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/synthetic_multigrid.hpp"
#include "runtime/greenloop_multigrid.h"
#include "runtime/multigrid.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t plenty = std::uint64_t{1} << 40;

TEST_CASE("C steps a multigrid model the same, bit for bit") {
  const ModelFile file = encoded_file(synthetic_multigrid({.cells = 4}));
  const Model model = Model::open(file.bytes.span()).model;
  greenloop_model c_model;
  REQUIRE(greenloop_open(file.bytes.data(), file.bytes.size(), &c_model).rule == GREENLOOP_RULE_OK);
  const layout::MultigridInfo& info = *file.view.multigrid.info;
  CHECK(greenloop_model_problem(&c_model) == static_cast<int>(layout::Problem::multigrid));
  CHECK(greenloop_multigrid_vertices(&c_model) == info.vertices);
  CHECK(greenloop_multigrid_shown_vertices(&c_model) == info.shown);
  CHECK(greenloop_multigrid_time_step(&c_model) == info.time_step);
  const greenloop_multigrid_limits c_limits = {3, 2, 0};
  const Multigrid::Limits limits{.max_loads = 3, .max_holds = 2};
  const Multigrid::Requirement need = Multigrid::required(model, limits);
  const greenloop_multigrid_requirement c_need = greenloop_multigrid_required(&c_model, c_limits);
  CHECK(c_need.bytes == need.bytes);
  CHECK(c_need.least_work == need.least_work);
  CHECK(c_need.cycle_work == need.cycle_work);
  CHECK(c_need.shown_work == need.shown_work);
  CHECK(c_need.stress_work == need.stress_work);
  AlignedBytes memory(need.bytes), c_memory(need.bytes);
  Multigrid body = Multigrid::create(model, limits, {memory.data(), memory.size()}).body;
  const auto created = greenloop_multigrid_create(&c_model, c_limits, c_memory.data(), c_memory.size());
  REQUIRE(created.error == GREENLOOP_CREATE_OK);
  std::vector<Vec3> displacement(info.vertices), c_displacement(info.vertices), shown(info.shown), c_shown(info.shown);
  std::vector<float> stress(info.vertices), c_stress(info.vertices);
  Vec3 reaction{}, c_reaction{};
  for (int i = 0; i < 200; ++i) {
    const float travel = 1e-5F * static_cast<float>(i);
    const Multigrid::Load load{static_cast<std::uint32_t>(i) % info.free, {0, 0.01F, 0}};
    const Multigrid::Hold hold{5, {travel, 0, 0}};
    const Vec3 gravity{0, 0, -1};
    const Multigrid::Inputs inputs{{&load, 1}, {&hold, i < 100 ? std::size_t{0} : 1}, i % 2 == 0 ? &gravity : nullptr};
    const Multigrid::Response response{
        .displacement = displacement, .reaction = {&reaction, inputs.holds.size()}, .shown = shown, .stress = stress};
    const auto report = body.step(inputs, {plenty}, response);
    const greenloop_multigrid_load c_load = {load.vertex, {0, 0.01F, 0}};
    const greenloop_multigrid_hold c_hold = {5, {travel, 0, 0}};
    const float c_gravity[3] = {0, 0, -1};
    const greenloop_multigrid_inputs c_inputs = {&c_load, 1, &c_hold, inputs.holds.size(),
                                                 i % 2 == 0 ? c_gravity : nullptr};
    const greenloop_multigrid_buffers buffers = {&c_displacement[0].x, nullptr,       info.vertices,
                                                 &c_reaction.x,        &c_shown[0].x, c_stress.data()};
    const auto c_report = greenloop_multigrid_step(created.body, c_inputs, plenty, buffers);
    REQUIRE(static_cast<int>(c_report.status) == static_cast<int>(report.status));
    REQUIRE(greenloop_answered(c_report.status));
    CHECK(c_report.work == report.work);
    CHECK(c_report.cycles == report.cycles);
    CHECK(c_report.passes == report.passes);
    CHECK(c_report.residual == report.residual);
    CHECK(std::memcmp(displacement.data(), c_displacement.data(), displacement.size() * sizeof(Vec3)) == 0);
    CHECK(std::memcmp(shown.data(), c_shown.data(), shown.size() * sizeof(Vec3)) == 0);
    CHECK(stress == c_stress);
    CHECK(reaction.x == c_reaction.x);
    CHECK(reaction.y == c_reaction.y);
    CHECK(reaction.z == c_reaction.z);
  }
  CHECK(c_reaction.x != 0);
  const greenloop_multigrid_energy energy = greenloop_multigrid_energy_of(created.body);
  CHECK(energy.kinetic == body.energy().kinetic);
  CHECK(energy.elastic == body.energy().elastic);
  CHECK(energy.elastic > 0);
}

TEST_CASE("C chooses vertices, and is refused by name") {
  const ModelFile file = encoded_file(synthetic_multigrid({}));
  greenloop_model model;
  REQUIRE(greenloop_open(file.bytes.data(), file.bytes.size(), &model).rule == GREENLOOP_RULE_OK);
  CHECK(greenloop_multigrid_required(&model, {1, 1, 2.0F}).bytes == 0);
  const greenloop_multigrid_limits limits = {1, 1, 0.01F};
  AlignedBytes memory(greenloop_multigrid_required(&model, limits).bytes);
  CHECK(greenloop_multigrid_create(&model, limits, memory.data(), memory.size() - 1).error ==
        GREENLOOP_CREATE_ARENA_TOO_SMALL);
  greenloop_multigrid* const body = greenloop_multigrid_create(&model, limits, memory.data(), memory.size()).body;
  REQUIRE(body != nullptr);
  const greenloop_multigrid_load load = {1, {0, 0, 1}}, none = {1, {0, std::nanf(""), 0}};
  const std::uint32_t chosen[] = {1};
  float displacement[3] = {};
  const greenloop_multigrid_buffers buffers = {displacement, chosen, 1, nullptr, nullptr, nullptr};
  CHECK(greenloop_answered(greenloop_multigrid_step(body, {&load, 1, nullptr, 0, nullptr}, plenty, buffers).status));
  CHECK(displacement[2] > 0);
  const float before = displacement[2];
  const auto refused = greenloop_multigrid_step(body, {&none, 1, nullptr, 0, nullptr}, plenty, buffers);
  CHECK(refused.status == GREENLOOP_HELD_NOT_FINITE);
  CHECK(refused.refused == 0);
  CHECK(greenloop_multigrid_step(body, {}, 1, buffers).status == GREENLOOP_HELD_OVER_BUDGET);
  CHECK(displacement[2] == before);
  const ModelFile other = encoded_file(synthetic_model({.levels = 1}));
  REQUIRE(greenloop_open(other.bytes.data(), other.bytes.size(), &model).rule == GREENLOOP_RULE_OK);
  CHECK(greenloop_multigrid_vertices(&model) == 0);
  CHECK(greenloop_multigrid_create(&model, limits, memory.data(), memory.size()).error ==
        GREENLOOP_CREATE_UNSUPPORTED_MODEL);
}

}  // namespace
}  // namespace greenloop
