#include "runtime/vibrating_body.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "formats/testing/synthetic_motion.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/algebra/fnv1a.hpp"
#include "runtime/greenloop_vibrating.h"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// motions of the surface of another model: of its nodes in the reverse order, behind some vertices that it does not
// have
ImpulseResponseData motion_of(const TestModel& touched, std::uint32_t further = 5) {
  const std::uint32_t nodes = touched.model().node_count();
  ImpulseResponseData data = synthetic_motion({.vertices = nodes + further, .modes = 6, .alternating = true});
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const float* const x = node_record(touched.view(), i).position;
    std::copy_n(x, 3, data.shape.begin() + std::ptrdiff_t{3} * (further + nodes - 1 - i));
  }
  for (std::uint32_t i = 0; i < 3 * further; ++i) data.shape[i] = 10;
  return data;
}

VibratingBody::Limits usual() {
  VibratingBody::Limits limits;
  limits.contact.elastostatic = {.max_contacts = 48, .cached_factors = 4, .iterations = 50};
  limits.contact.max_tools = 1;
  return limits;
}

class Vibrating {
 public:
  Vibrating() : need(VibratingBody::required(touched.model(), moving.model(), usual())), memory_(need.bytes) {
    const auto created =
        VibratingBody::create(touched.model(), moving.model(), usual(), {memory_.data(), memory_.size()});
    REQUIRE(created);
    body = created.body;
  }
  TestModel touched{SyntheticOptions{.levels = 3}};
  TestModel moving{encode(motion_of(touched))};
  VibratingBody::Requirement need;
  VibratingBody body;

 private:
  AlignedBytes memory_;
};

ContactBody::ToolInput ball(const Double3& centre) { return {{Shape::sphere(0.3), {centre, {1, 0, 0, 0}}}, 0.4}; }

double top_of(const TestModel& model) {
  float top = 0;
  for (std::uint32_t i = 0; i < model.model().node_count(); ++i) {
    top = std::max(top, node_record(model.view(), i).position[2]);
  }
  return double{top};
}

TEST_CASE("a surface that is carried without a turn answers as one that stands still and is touched elsewhere") {
  const TestModel model({.levels = 3});
  ContactBody::Limits limits = usual().contact;
  limits.carried = true;
  const auto bytes = ContactBody::required(model.model(), limits).bytes;
  AlignedBytes memory_a(bytes), memory_b(bytes);
  auto still = ContactBody::create(model.model(), limits, {memory_a.data(), bytes});
  auto moved = ContactBody::create(model.model(), limits, {memory_b.data(), bytes});
  REQUIRE((still && moved));
  std::vector<Vec4> offset(model.model().node_count());
  REQUIRE(moved.body.carry(offset));
  const double top = top_of(model);
  double pushed = 0;
  for (int k = 0; k < 60; ++k) {
    const int away = k % 32 < 16 ? k % 32 : 32 - k % 32;  // to and fro, 0.24 mm a step
    const float shift = 0x1p-12F * static_cast<float>(away);
    for (Vec4& o : offset) o = {shift, 0, -shift, 0};
    const Double3 centre{0.0005 * k, 0, top + 0.3 - 0.01 * std::min(k, 20) / 20};
    const auto a = ball(centre), b = ball(centre + Double3{double{shift}, 0, -double{shift}});
    REQUIRE(answered(still.body.step({&a, 1}, {}, {any_budget}).status));
    const auto report = moved.body.step({&b, 1}, {}, {any_budget});
    REQUIRE(answered(report.status));
    CHECK(report.touching_work <= moved.body.touching_work({&b, 1}));
    const Double3 expected = still.body.tools()[0].force, force = moved.body.tools()[0].force;
    CHECK(norm(force - expected) <= 2e-3 * norm(expected) + 1e-9);
    pushed = std::max(pushed, norm(force));
  }
  CHECK(pushed > 0);
  CHECK(moved.body.energy().in == doctest::Approx(still.body.energy().in).epsilon(0.01));
}

TEST_CASE("carrying is refused where it was not asked for, of another size, and of what is not finite") {
  const TestModel model({.levels = 2});
  ContactBody::Limits limits = usual().contact;
  const auto plain_need = ContactBody::required(model.model(), limits);
  limits.carried = true;
  const auto need = ContactBody::required(model.model(), limits);
  CHECK(need.bytes > plain_need.bytes);
  CHECK(need.least_work > plain_need.least_work);
  AlignedBytes memory(need.bytes);
  std::vector<Vec4> offset(model.model().node_count());
  {
    limits.carried = false;
    auto plain = ContactBody::create(model.model(), limits, {memory.data(), memory.size()});
    REQUIRE(plain);
    CHECK_FALSE(plain.body.carry(offset));
    CHECK(plain.body.carry({}));
  }
  limits.carried = true;
  auto created = ContactBody::create(model.model(), limits, {memory.data(), memory.size()});
  REQUIRE(created);
  CHECK_FALSE(created.body.carry(std::span(offset).first(offset.size() - 1)));
  REQUIRE(created.body.carry(offset));
  const auto tool = ball({0, 0, top_of(model) + 0.28});
  REQUIRE(answered(created.body.step({&tool, 1}, {}, {any_budget}).status));
  const Double3 felt = created.body.tools()[0].force;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    offset[3].y = bad;
    CHECK(created.body.step({&tool, 1}, {}, {any_budget}).status == Status::held_not_finite);
    CHECK(norm(created.body.tools()[0].force - felt) == 0);
  }
  offset[3].y = 0;
  CHECK(answered(created.body.step({&tool, 1}, {}, {any_budget}).status));
}

TEST_CASE(
    "a ball that stands still feels a body vibrate against it, and nothing when it has come to rest away from it") {
  Vibrating vibrating;
  const auto tool = ball({0, 0, top_of(vibrating.touched) + 0.3 + 0.001});
  double least = std::numeric_limits<double>::infinity(), most = 0, moved = 0;
  for (int k = 0; k < 4000; ++k) {
    const std::uint32_t impulse = k % 500 == 0 && k < 2000 ? static_cast<std::uint32_t>(k / 500 % 2) : 0xffffffffU;
    const auto report = vibrating.body.step(impulse, {&tool, 1}, {}, {vibrating.need.worst_work});
    REQUIRE(answered(report.motion.status));
    REQUIRE(answered(report.contact.status));
    REQUIRE(report.work <= vibrating.need.worst_work);
    const double force = norm(vibrating.body.contact().tools()[0].force);
    least = std::min(least, force);
    most = std::max(most, force);
    for (const Vec4& o : vibrating.body.offset()) moved = std::max(moved, std::abs(double{o.z}));
  }
  CHECK(moved > 0.001);
  CHECK(most > 0);
  CHECK(least == 0);
}

TEST_CASE("displacements add, and each vertex moves the node at its place") {
  Vibrating vibrating;
  const auto need = ImpulseResponse::required(vibrating.moving.model(), {});
  AlignedBytes memory(need.bytes);
  auto alone = ImpulseResponse::create(vibrating.moving.model(), {}, {memory.data(), memory.size()});
  REQUIRE(alone);
  const std::uint32_t nodes = vibrating.touched.model().node_count();
  std::vector<Vec3> moved(nodes + 5);
  const auto tool = ball({0, 0, top_of(vibrating.touched) + 0.28});
  for (std::uint32_t k = 0; k < 50; ++k) {
    const std::uint32_t impulse = k == 3 ? 1 : ImpulseResponse::no_impulse;
    REQUIRE(answered(vibrating.body.step(impulse, {&tool, 1}, {}, {vibrating.need.worst_work}).contact.status));
    REQUIRE(answered(alone.body.step(impulse, {need.worst_work}, {.displacement = moved}).status));
    for (std::uint32_t i = 0; i < nodes; ++i) {
      const Vec3& expected = moved[5 + nodes - 1 - i];
      REQUIRE(vibrating.body.offset()[i].z == expected.z);
      REQUIRE(vibrating.body.displacement()[i].z == expected.z + vibrating.body.contact().displacement()[i].z);
    }
  }
}

TEST_CASE("where the mean of the motions is not the scene at rest, nodes are matched to that and moved from it") {
  const TestModel touched({.levels = 3});
  ImpulseResponseData data = motion_of(touched);
  for (std::size_t i = 0; i < 2 * data.groups[0].amplitudes.size(); ++i) data.groups[0].coordinates[i] = 20000;
  std::vector<Vec3> at_rest(data.shape.size() / 3);
  {
    const TestModel moving(encode(data));
    const auto need = ImpulseResponse::required(moving.model(), {});
    AlignedBytes memory(need.bytes);
    auto created = ImpulseResponse::create(moving.model(), {}, {memory.data(), memory.size()});
    REQUIRE(created);
    REQUIRE(
        answered(created.body.step(ImpulseResponse::no_impulse, {need.worst_work}, {.displacement = at_rest}).status));
  }
  double largest = 0;
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    data.shape[3 * i] -= at_rest[i].x;
    data.shape[3 * i + 1] -= at_rest[i].y;
    data.shape[3 * i + 2] -= at_rest[i].z;
    largest = std::max(largest, std::abs(double{at_rest[i].x}));
  }
  CHECK(largest > 0.003);
  const TestModel moving(encode(data));
  AlignedBytes memory(VibratingBody::required(touched.model(), moving.model(), usual()).bytes);
  auto created = VibratingBody::create(touched.model(), moving.model(), usual(), {memory.data(), memory.size()});
  REQUIRE(created);
  REQUIRE(answered(created.body.step(ImpulseResponse::no_impulse, {}, {}, {any_budget}).motion.status));
  for (const Vec4& u : created.body.offset()) CHECK(std::abs(u.x) + std::abs(u.y) + std::abs(u.z) == 0);
}

TEST_CASE("an impulse that may not follow holds the surface where it is, and tools are answered on it") {
  Vibrating vibrating;
  const auto tool = ball({0, 0, top_of(vibrating.touched) + 0.29});
  const auto step = [&](std::uint32_t impulse, std::uint64_t work) {
    return vibrating.body.step(impulse, {&tool, 1}, {}, {work});
  };
  REQUIRE(answered(step(0, vibrating.need.worst_work).motion.status));
  CHECK_FALSE(vibrating.body.motion().may_follow(0));
  const std::vector<Vec4> before(vibrating.body.offset().begin(), vibrating.body.offset().end());
  const auto refused = step(0, vibrating.need.worst_work);
  CHECK(refused.motion.status == Status::held_illegal_impulse);
  CHECK(answered(refused.contact.status));
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(vibrating.body.offset()[i].x == before[i].x);
  const auto starved = step(1, vibrating.need.least_work - 1);
  CHECK(starved.motion.status == Status::held_over_budget);
  CHECK(starved.contact.status == Status::held_over_budget);
}

TEST_CASE("budgets from the least to the worst are never exceeded, and give the same bits in every run") {
  const auto run = [] {
    Vibrating vibrating;
    Fnv1a digest;
    const std::uint64_t range = vibrating.need.worst_work - vibrating.need.least_work;
    std::uint32_t coarser = 0;
    for (std::uint32_t k = 0; k < 600; ++k) {
      const std::uint64_t work = vibrating.need.least_work + range * (k % 7) / 12;
      const double down = 0.02 * std::min(k, 100U) / 100;
      const auto tool = ball({0.0005 * k, 0, top_of(vibrating.touched) + 0.3 - down});
      const auto report = vibrating.body.step(k % 50 == 0 ? k / 50 % 2 : 0xffffffffU, {&tool, 1}, {}, {work});
      REQUIRE(answered(report.motion.status));
      REQUIRE(answered(report.contact.status));
      REQUIRE(report.work <= work);
      coarser += report.motion.status == Status::coarser ? 1 : 0;
      digest.add(std::as_bytes(vibrating.body.displacement()));
      digest.add(std::as_bytes(std::span(&vibrating.body.contact().tools()[0].force, 1)));
    }
    CHECK(coarser > 0);
    return digest.value();
  };
  CHECK(run() == run());
}

TEST_CASE("the C functions give the same bits") {
  Vibrating vibrating;
  greenloop_model touched, moving;
  const AlignedBytes a(encode(synthetic_model({.levels = 3}))), b(encode(motion_of(vibrating.touched)));
  REQUIRE(greenloop_open(a.data(), a.size(), &touched).rule == GREENLOOP_RULE_OK);
  REQUIRE(greenloop_open(b.data(), b.size(), &moving).rule == GREENLOOP_RULE_OK);
  greenloop_vibrating_body_limits limits{};
  limits.contact.elastostatic.max_contacts = 48;
  limits.contact.elastostatic.cached_factors = 4;
  limits.contact.elastostatic.iterations = 50;
  limits.contact.max_tools = 1;
  const auto need = greenloop_vibrating_body_required(&touched, &moving, limits);
  CHECK(need.bytes == vibrating.need.bytes);
  CHECK(need.least_work == vibrating.need.least_work);
  CHECK(need.worst_work == vibrating.need.worst_work);
  AlignedBytes memory(need.bytes);
  const auto created = greenloop_vibrating_body_create(&touched, &moving, limits, memory.data(), memory.size());
  REQUIRE(created.error == GREENLOOP_CREATE_OK);
  CHECK(greenloop_vibrating_body_create(&touched, &touched, limits, memory.data(), memory.size()).error ==
        GREENLOOP_CREATE_UNSUPPORTED_MODEL);
  const auto tool = ball({0, 0, top_of(vibrating.touched) + 0.29});
  greenloop_tool c_tool{};
  c_tool.shape.kind = GREENLOOP_SHAPE_SPHERE;
  c_tool.shape.size[0] = 0.3;
  c_tool.position[2] = top_of(vibrating.touched) + 0.29;
  c_tool.quaternion[0] = 1;
  c_tool.friction = 0.4;
  for (std::uint32_t k = 0; k < 100; ++k) {
    const std::uint32_t impulse = k % 20 == 0 ? k / 20 % 2 : GREENLOOP_NO_IMPULSE;
    const auto expected = vibrating.body.step(impulse, {&tool, 1}, {}, {need.worst_work});
    const auto report = greenloop_vibrating_body_step(created.body, impulse, &c_tool, 1, nullptr, need.worst_work);
    REQUIRE(report.work == expected.work);
    REQUIRE(report.motion.modes == expected.motion.modes);
    std::size_t nodes = 0, tools = 0;
    const float* const u = greenloop_vibrating_body_displacement(created.body, &nodes);
    REQUIRE(nodes == vibrating.body.displacement().size());
    for (std::size_t i = 0; i < nodes; ++i) REQUIRE(u[std::size_t{4} * i + 2] == vibrating.body.displacement()[i].z);
    REQUIRE(greenloop_vibrating_body_offset(created.body, &nodes)[0] == vibrating.body.offset()[0].x);
    const auto* felt = greenloop_contact_body_tools(greenloop_vibrating_body_contact(created.body), &tools);
    REQUIRE(felt[0].force[2] == vibrating.body.contact().tools()[0].force.z);
  }
  CHECK(greenloop_vibrating_body_may_follow(created.body, 0) == (vibrating.body.motion().may_follow(0) ? 1 : 0));
}

TEST_CASE("models that do not match, and memory that is too small, are refused by name") {
  const TestModel touched({.levels = 3}), other({.levels = 2});
  const TestModel moving(encode(motion_of(touched))), fewer(encode(motion_of(other)));
  const auto refusal = [&](const Model& a, const Model& b, std::size_t short_of = 0) {
    AlignedBytes memory(VibratingBody::required(a, b, usual()).bytes);
    return VibratingBody::create(a, b, usual(), {memory.data(), memory.size() - short_of}).error;
  };
  CHECK(refusal(touched.model(), moving.model()) == CreateError::none);
  CHECK(refusal(touched.model(), moving.model(), 1) == CreateError::arena_too_small);
  CHECK(refusal(touched.model(), fewer.model()) == CreateError::mismatched_models);
  CHECK(refusal(moving.model(), touched.model()) == CreateError::unsupported_model);
  CHECK(refusal(touched.model(), touched.model()) == CreateError::unsupported_model);
  ImpulseResponseData shifted = motion_of(touched);
  shifted.shape[60] += 1e-2F;
  CHECK(refusal(touched.model(), TestModel(encode(shifted)).model()) == CreateError::mismatched_models);
}

}  // namespace
}  // namespace greenloop
