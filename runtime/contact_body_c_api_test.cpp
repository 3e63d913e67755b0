#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <set>
#include <vector>

#include "runtime/contact_body.hpp"
#include "runtime/greenloop_contact.h"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr SyntheticOptions options{.levels = 3, .touchable_above = -0.4, .gravity = true};

// a tetrahedron whose vertices are 3 cm from the origin
constexpr double vertex[] = {0.017, 0.017, 0.017, 0.017, -0.017, -0.017, -0.017, 0.017, -0.017, -0.017, -0.017, 0.017};
constexpr std::uint32_t face[] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};

template <class A, class B>
bool same_bytes(const A& a, const B& b) {
  static_assert(sizeof a == sizeof b);
  return std::memcmp(&a, &b, sizeof a) == 0;
}

struct CModel {
  CModel() : bytes(encode(synthetic_model(options))) {
    REQUIRE(greenloop_open(bytes.data(), bytes.size(), &model).rule == GREENLOOP_RULE_OK);
  }
  AlignedBytes bytes;
  greenloop_model model{};
};

void check_same(const greenloop_elastostatic_report& c, const Elastostatic::StepReport& cpp) {
  REQUIRE(static_cast<int>(c.status) == static_cast<int>(cpp.status));
  CHECK(c.refused == cpp.refused);
  CHECK(c.work == cpp.work);
  CHECK(c.constraint_level == cpp.constraint_level);
  CHECK(c.field_level == cpp.field_level);
  CHECK(c.details.needed_work == cpp.details.needed_work);
}

greenloop_elastostatic_limits c_limits(const Elastostatic::Limits& limits) {
  greenloop_elastostatic_limits same{};
  same.max_contacts = limits.max_contacts;
  same.cached_factors = limits.cached_factors;
  same.model_loads = limits.model_loads ? 1 : 0;
  same.iterations = limits.iterations;
  return same;
}

TEST_CASE("surfaces that push are answered the same through C, bit for bit") {
  constexpr Elastostatic::Limits limits{.max_contacts = 12, .cached_factors = 2, .iterations = 20, .model_loads = true};
  const TestModel model(options);
  TestBody cpp(model, limits);
  CModel c;
  const auto need = greenloop_elastostatic_required(&c.model, c_limits(limits));
  CHECK(need.bytes == cpp.requirement().bytes);
  AlignedBytes arena(need.bytes);
  auto* const body = greenloop_elastostatic_create(&c.model, c_limits(limits), arena.data(), arena.size()).body;
  REQUIRE(body != nullptr);
  const std::uint32_t nodes = greenloop_node_count(&c.model);
  AlignedBytes field(std::size_t{16} * nodes), gaps(std::size_t{16} * 4);
  const auto touchable = model.touchable();
  std::mt19937_64 random(8);
  std::set<int> statuses, states;
  for (int i = 0; i < 200; ++i) {
    std::vector<greenloop_unilateral_contact> contacts(random() % 5);
    std::vector<UnilateralContact> same;
    for (auto& contact : contacts) {
      const std::size_t first = random() % touchable.size();
      const auto part = [&](double size) {
        return static_cast<float>(size * (static_cast<double>(random() % 200) / 100 - 1));
      };
      contact = {{touchable[first], touchable[(first + 1) % touchable.size()], GREENLOOP_NONE},
                 {0.75F, 0.25F, 0},
                 {part(1e-3), part(1e-3), part(1e-3)},
                 {0.6F, 0, i % 20 == 19 ? 0.5F : -0.8F},
                 0.4F,
                 0,
                 {},
                 static_cast<std::uint32_t>(first % 2),
                 first % 2 == 0 ? 1e-4F : 0};
      UnilateralContact& to = same.emplace_back();
      std::memcpy(static_cast<void*>(&to), &contact, sizeof to);
    }
    const std::uint64_t work = need.least_work - 1 + random() % need.worst_work[2];
    greenloop_loads loads{};
    loads.gravity[1] = i % 3 == 0 ? -9.81F : 0;
    loads.stiffness = 2;
    std::vector<float> force(3 * contacts.size());
    std::vector<std::uint8_t> state(contacts.size());
    const auto report = greenloop_elastostatic_push(body, contacts.data(), contacts.size(), &loads, work, force.data(),
                                                    state.data(), reinterpret_cast<float*>(gaps.data()),
                                                    reinterpret_cast<float*>(field.data()), nodes);
    std::vector<float> expected_force(force.size());
    std::vector<ContactState> expected_state(contacts.size());
    std::vector<Vec4> expected_gap(contacts.size());
    Elastostatic::UnilateralResponse response;
    response.force = as_vec3(std::span(expected_force));
    response.displacement = as_vec4(cpp.field());
    response.state = expected_state;
    response.gap = expected_gap;
    const auto expected =
        cpp.body().step(same, {.gravity = {0, loads.gravity[1], 0}, .stiffness = 2}, {work}, response);
    check_same(report.step, expected);
    CHECK(report.residual == expected.residual);
    CHECK(report.iterations == expected.iterations);
    statuses.insert(report.step.status);
    if (!greenloop_answered(report.step.status)) continue;
    CHECK(force == expected_force);
    CHECK((state.empty() || std::memcmp(state.data(), expected_state.data(), state.size()) == 0));
    CHECK((state.empty() || std::memcmp(gaps.data(), expected_gap.data(), sizeof(Vec4) * state.size()) == 0));
    CHECK(std::memcmp(field.data(), cpp.field().data(), field.size()) == 0);
    states.insert(state.begin(), state.end());
  }
  CHECK(statuses.count(GREENLOOP_OK) == 1);
  CHECK(statuses.count(GREENLOOP_HELD_BAD_SURFACE) == 1);
  CHECK(states.size() >= 2);
}

TEST_CASE("a body that tools touch is answered the same through C, bit for bit") {
  ContactBody::Limits limits;
  limits.elastostatic = {.max_contacts = 40, .cached_factors = 3, .iterations = 20};
  limits.max_tools = 6;
  greenloop_contact_body_limits same{};
  same.elastostatic = c_limits(limits.elastostatic);
  same.max_tools = 6;
  const TestModel model(options);
  CModel c;
  const auto requirement = ContactBody::required(model.model(), limits);
  const auto need = greenloop_contact_body_required(&c.model, same);
  CHECK(need.bytes == requirement.bytes);
  CHECK(need.least_work == requirement.least_work);
  CHECK(need.worst_work == requirement.worst_work);
  CHECK(need.touching_work == requirement.touching_work);
  AlignedBytes cpp_memory(need.bytes), c_memory(need.bytes);
  auto cpp = ContactBody::create(model.model(), limits, {cpp_memory.data(), cpp_memory.size()});
  const auto made = greenloop_contact_body_create(&c.model, same, c_memory.data(), c_memory.size());
  REQUIRE(cpp);
  REQUIRE(made.error == GREENLOOP_CREATE_OK);

  AlignedBytes cpp_solid(ConvexPolyhedron::required(4, 4)), c_solid(greenloop_polyhedron_required(4, 4));
  const auto solid = ConvexPolyhedron::create({reinterpret_cast<const Double3*>(vertex), 4},
                                              {reinterpret_cast<const ConvexPolyhedron::Face*>(face), 4},
                                              {cpp_solid.data(), cpp_solid.size()});
  const auto c_made = greenloop_polyhedron_create(vertex, 4, face, 4, c_solid.data(), c_solid.size());
  REQUIRE(solid);
  REQUIRE(c_made.error == GREENLOOP_POLYHEDRON_OK);

  const Shape shapes[] = {Shape(),
                          Shape::sphere(0.03),
                          Shape::capsule(0.02, 0.04),
                          Shape::box({0.02, 0.03, 0.01}),
                          Shape::plane(),
                          Shape::polyhedron(solid.polyhedron)};
  const greenloop_shape c_shapes[] = {{GREENLOOP_SHAPE_POINT, {}, nullptr},
                                      {GREENLOOP_SHAPE_SPHERE, {0.03}, nullptr},
                                      {GREENLOOP_SHAPE_CAPSULE, {0.02, 0.04}, nullptr},
                                      {GREENLOOP_SHAPE_BOX, {0.02, 0.03, 0.01}, nullptr},
                                      {GREENLOOP_SHAPE_PLANE, {}, nullptr},
                                      {GREENLOOP_SHAPE_POLYHEDRON, {}, c_made.polyhedron}};
  const double way[][3] = {{-0.6, -0.8, 0}, {0.6, 0, 0.8}, {-0.6, 0, 0.8}, {0, 0.8, 0.6}, {0, 0, 1}, {0, -0.8, 0.6}};
  const double distance[] = {0.1, 0.13, 0.12, 0.115, 0.1, 0.118};
  std::vector<float> rough(greenloop_node_count(&c.model));
  for (std::size_t i = 0; i < rough.size(); ++i) rough[i] = 0.25F * static_cast<float>(i % 8);
  std::size_t touches = 0;
  bool felt[6] = {};
  for (int i = 0; i < 60; ++i) {
    std::vector<ContactBody::ToolInput> tools;
    std::vector<greenloop_tool> c_tools;
    for (int t = 0; t < 6; ++t) {
      const double at = distance[t] - 3e-4 * i;
      const Double3 place{at * way[t][0] + 2e-4 * i, at * way[t][1], at * way[t][2]};
      const bool is_plane = t == 4;  // upside down
      const double w = is_plane ? 0 : 1, x = is_plane ? 1 : 0;
      tools.push_back({{shapes[t], {place, {w, x, 0, 0}}}, 0.1 * t, t == 1 ? 1e-4 : 0});
      c_tools.push_back({c_shapes[t], {place.x, place.y, place.z}, {w, x, 0, 0}, 0.1 * t, t == 1 ? 1e-4 : 0});
    }
    tools[2].tool.pose.quaternion[1] = c_tools[2].quaternion[1] = i == 30 ? 0.5 : 0;
    if (i == 20) {
      cpp.body.surface_friction(rough);
      greenloop_contact_body_surface_friction(made.body, rough.data(), rough.size());
    }
    if (i == 40) cpp.body.forget(1), greenloop_contact_body_forget(made.body, 1);
    const std::uint64_t touching = cpp.body.touching_work(tools);
    CHECK(greenloop_contact_body_touching_work(made.body, c_tools.data(), c_tools.size()) == touching);
    CHECK(touching <= need.touching_work);
    const std::uint64_t work = i % 7 == 6 ? need.least_work - 1 : i % 7 == 5 ? need.least_work : need.worst_work;
    const auto expected = cpp.body.step(tools, {}, {work});
    const auto report = greenloop_contact_body_step(made.body, c_tools.data(), c_tools.size(), nullptr, work);
    check_same(report.contact.step, expected);
    CHECK(report.contact.residual == expected.residual);
    CHECK(report.contact.iterations == expected.iterations);
    CHECK(report.touching_work == expected.touching_work);
    CHECK(report.left_out == expected.left_out);
    CHECK(report.deepest_left_out == expected.deepest_left_out);
    CHECK(report.left_out_tool == expected.left_out_place.tool);
    for (int k = 0; k < 3; ++k) {
      CHECK(report.left_out_node[k] == expected.left_out_place.node[k]);
      CHECK(report.left_out_weight[k] == expected.left_out_place.weight[k]);
    }
    CHECK(report.unfinished == expected.unfinished);
    std::size_t count = 0;
    const greenloop_tool_answer* const answers = greenloop_contact_body_tools(made.body, &count);
    REQUIRE(count == cpp.body.tools().size());
    for (std::size_t t = 0; t < count; ++t) {
      const ContactBody::ToolAnswer& answer = cpp.body.tools()[t];
      CHECK(answers[t].fault == static_cast<int>(answer.fault));
      CHECK(same_bytes(answers[t].force, answer.force));
      CHECK(same_bytes(answers[t].torque, answer.torque));
      CHECK(answers[t].first_contact == answer.first_contact);
      CHECK(answers[t].contacts == answer.contacts);
      CHECK(answers[t].depth == answer.depth);
      CHECK(same_bytes(answers[t].sag, answer.sag));
      felt[t] |= norm(answer.force) > 0;
    }
    const greenloop_touch* const touch = greenloop_contact_body_contacts(made.body, &count);
    REQUIRE(count == cpp.body.contacts().size());
    for (std::size_t k = 0; k < count; ++k) {
      const ContactBody::Contact& contact = cpp.body.contacts()[k];
      CHECK(same_bytes(touch[k].node, contact.node));
      CHECK(same_bytes(touch[k].weight, contact.weight));
      CHECK(touch[k].tool == contact.tool);
      CHECK(touch[k].state == static_cast<int>(contact.state));
      CHECK(same_bytes(touch[k].position, contact.position));
      CHECK(same_bytes(touch[k].normal, contact.normal));
      CHECK(same_bytes(touch[k].force, contact.force));
      CHECK(touch[k].gap == contact.gap);
      CHECK(greenloop_contact_body_area(made.body, &touch[k]) == cpp.body.area(contact));
    }
    touches += count;
    const float* const field = greenloop_contact_body_displacement(made.body, &count);
    CHECK(std::memcmp(field, cpp.body.displacement().data(), cpp.body.displacement().size_bytes()) == 0);
    const greenloop_contact_energy energy = greenloop_contact_body_energy(made.body);
    CHECK(energy.in == cpp.body.energy().in);
    CHECK(energy.generated == cpp.body.energy().generated);
  }
  CHECK(touches > 100);
  CHECK(std::count(felt, felt + 6, true) == 6);
}

TEST_CASE("a local model is the same through C, bit for bit") {
  ContactBody::Limits limits;
  limits.elastostatic = {.max_contacts = 40, .cached_factors = 3, .iterations = 20};
  greenloop_contact_body_limits same{};
  same.elastostatic = c_limits(limits.elastostatic);
  const TestModel model(options);
  CModel c;
  AlignedBytes cpp_memory(ContactBody::required(model.model(), limits).bytes), c_memory(cpp_memory.size());
  ContactBody cpp = ContactBody::create(model.model(), limits, {cpp_memory.data(), cpp_memory.size()}).body;
  auto* const body = greenloop_contact_body_create(&c.model, same, c_memory.data(), c_memory.size()).body;
  const ContactBody::ToolInput tool{{Shape::sphere(0.03), {{0, 0, 0.125}, {1, 0, 0, 0}}}, 0.3};
  const greenloop_tool c_tool = {{GREENLOOP_SHAPE_SPHERE, {0.03}, nullptr}, {0, 0, 0.125}, {1, 0, 0, 0}, 0.3, 0};
  LocalModel cpp_model;
  greenloop_local_model c_model;
  CHECK(greenloop_contact_body_local_model(body, 1, 0.03F, &c_model) == 0);
  REQUIRE(answered(cpp.step({&tool, 1}, {}, {any_budget}).status));
  static_cast<void>(greenloop_contact_body_step(body, &c_tool, 1, nullptr, any_budget));
  for (const bool turns : {false, true}) {
    const std::uint64_t work = cpp.local_model(turns, 0.03F, cpp_model);
    CHECK(work > 0);
    CHECK(work <= cpp.local_model_work(1, turns));
    CHECK(greenloop_contact_body_local_model(body, turns ? 1 : 0, 0.03F, &c_model) == work);
    CHECK(same_bytes(c_model, cpp_model));
    const float motion[6] = {1e-6F, 2e-6F, 3e-6F, 1e-4F, 0, 0};
    float cpp_wrench[6], c_wrench[6];
    cpp_model.evaluate({motion, cpp_model.components}, cpp_wrench);
    greenloop_local_model_evaluate(&c_model, motion, c_wrench);
    CHECK(same_bytes(c_wrench, cpp_wrench));
    CHECK(greenloop_local_model_motion_length(&c_model, motion) ==
          cpp_model.motion_length({motion, cpp_model.components}));
  }
}

TEST_CASE("what C is given wrongly is refused by name") {
  CModel c;
  greenloop_contact_body_limits limits{};
  CHECK(greenloop_contact_body_required(&c.model, limits).bytes == 0);
  CHECK(greenloop_contact_body_create(&c.model, limits, nullptr, 0).error == GREENLOOP_CREATE_BAD_LIMITS);
  limits.elastostatic.max_contacts = 8;
  limits.elastostatic.cached_factors = 1;
  limits.elastostatic.iterations = 10;
  AlignedBytes memory(greenloop_contact_body_required(&c.model, limits).bytes);
  const auto made = greenloop_contact_body_create(&c.model, limits, memory.data(), memory.size());
  REQUIRE(made.error == GREENLOOP_CREATE_OK);
  greenloop_tool tools[40] = {};
  for (greenloop_tool& tool : tools) tool = {{GREENLOOP_SHAPE_POLYHEDRON, {}, nullptr}, {}, {1, 0, 0, 0}, 0.3, 0};
  constexpr std::uint64_t work = std::uint64_t{1} << 40;
  CHECK(greenloop_contact_body_step(made.body, tools, 40, nullptr, work).contact.step.status ==
        GREENLOOP_HELD_OUT_OF_RANGE);
  tools[1].shape.kind = static_cast<greenloop_shape_kind>(6);
  REQUIRE(greenloop_answered(greenloop_contact_body_step(made.body, tools, 2, nullptr, work).contact.step.status));
  std::size_t count = 0;
  CHECK(greenloop_contact_body_tools(made.body, &count)[0].fault == GREENLOOP_TOOL_BAD_SHAPE);
  CHECK(greenloop_contact_body_tools(made.body, &count)[1].fault == GREENLOOP_TOOL_BAD_SHAPE);
  CHECK(std::strstr(greenloop_tool_fault_text(GREENLOOP_TOOL_BAD_SHAPE), "shape") != nullptr);

  AlignedBytes solid(greenloop_polyhedron_required(4, 4));
  const auto short_of = greenloop_polyhedron_create(vertex, 4, face, 4, solid.data(), 10);
  CHECK(short_of.error == GREENLOOP_POLYHEDRON_MEMORY_TOO_SMALL);
  CHECK(short_of.missing == short_of.requested - 10);
  CHECK(short_of.polyhedron == nullptr);
  const std::uint32_t inward[] = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};
  const auto turned = greenloop_polyhedron_create(vertex, 4, inward, 4, solid.data(), solid.size());
  CHECK(turned.error == GREENLOOP_POLYHEDRON_INWARD);
  CHECK(std::strstr(greenloop_polyhedron_error_text(turned.error), "clockwise") != nullptr);
}

}  // namespace
}  // namespace greenloop
