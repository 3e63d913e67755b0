#include "runtime/elastostatic/unilateral.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// a body that unilateral contacts touch, with the buffers of its answer
class PushedBody {
 public:
  PushedBody(const TestModel& model, const Elastostatic::Limits& limits)
      : body_(model, limits), force_(3 * std::size_t{limits.max_contacts}), state_(limits.max_contacts) {}

  Elastostatic::UnilateralReport step(std::span<const UnilateralContact> contacts, std::uint64_t work = any_budget) {
    count_ = contacts.size();
    Elastostatic::UnilateralResponse response;
    response.force = as_vec3(std::span(force_).first(3 * count_));
    response.displacement = as_vec4(body_.field());
    response.state = std::span(state_).first(count_);
    return body_.body().step(contacts, {}, {work}, response);
  }
  [[nodiscard]] const Elastostatic::Requirement& requirement() const { return body_.requirement(); }
  [[nodiscard]] std::span<const float> force() const { return std::span(force_).first(3 * count_); }
  [[nodiscard]] std::span<const ContactState> state() const { return std::span(state_).first(count_); }
  [[nodiscard]] std::span<const float> field() const { return body_.field(); }
  [[nodiscard]] Vector3d force(std::size_t i) const { return {force_[3 * i], force_[3 * i + 1], force_[3 * i + 2]}; }
  [[nodiscard]] Vector3d displacement(std::uint32_t node) const {
    const float* u = field().data() + std::size_t{4} * node;
    return {u[0], u[1], u[2]};
  }

 private:
  TestBody body_;
  std::vector<float> force_;
  std::vector<ContactState> state_;
  std::size_t count_ = 0;
};

Vector3d normal_of(const UnilateralContact& c) { return {c.normal[0], c.normal[1], c.normal[2]}; }
Vector3d value_of(const UnilateralContact& c) { return {c.value[0], c.value[1], c.value[2]}; }

UnilateralContact contact_at(std::uint32_t node, const Vector3d& normal, const Vector3d& value, double friction) {
  const Vector3d n = normal.normalized();
  UnilateralContact contact;
  contact.node[0] = node;
  for (int r = 0; r < 3; ++r) {
    contact.value[r] = static_cast<float>(value(r));
    contact.normal[r] = static_cast<float>(n(r));
  }
  contact.friction = static_cast<float>(friction);
  return contact;
}

// surfaces that push into a patch of the sphere from outside and drag it along, the nodes at its rim from some way off
std::vector<UnilateralContact> pushed_patch(const TestModel& model, std::size_t count, double depth, double drag,
                                            double friction, std::size_t first = 0) {
  std::vector<std::uint32_t> nodes = model.touchable();
  const auto position = [&](std::uint32_t node) {
    const float* x = node_record(model.view(), node).position;
    return Vector3d(x[0], x[1], x[2]);
  };
  const Vector3d pole = position(nodes[first]);
  std::stable_sort(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) {
    return (position(a) - pole).norm() < (position(b) - pole).norm();
  });
  std::vector<UnilateralContact> contacts;
  const double reach = (position(nodes[count - 1]) - pole).norm();
  for (std::size_t i = 0; i < count; ++i) {
    const double away = (position(nodes[i]) - pole).norm() / reach;
    const Vector3d along = pole.unitOrthogonal();
    contacts.push_back(contact_at(nodes[i], -position(nodes[i]),
                                  depth * (1 - 1.6 * away * away) * -pole.normalized() + drag * along, friction));
  }
  return contacts;
}

Vector3d project(double friction, const Vector3d& normal, const Vector3d& f) {
  const double n = f.dot(normal);
  const Vector3d t = f - n * normal;
  if (t.norm() <= friction * n) return f;
  if (friction * t.norm() <= -n) return Vector3d::Zero();
  const double pressed = (n + friction * t.norm()) / (1 + friction * friction);
  return pressed * normal + friction * pressed * t.normalized();
}

// the compliance between contacts at the finest level, in double precision
MatrixXd compliance_of(const TestModel& model, const DenseReference& reference,
                       const std::vector<UnilateralContact>& contacts) {
  const std::uint32_t finest = model.view().levels - 1;
  std::vector<NodeFacts> facts(model.view().node_count);
  list_node_facts(model.view(), facts.data());
  const auto n = static_cast<Index>(contacts.size());
  MatrixXd a(3 * n, 3 * n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const Index row = column_place(column_of(model.view(), facts.data(), contacts[i].node[0], finest));
      const Index column = column_place(column_of(model.view(), facts.data(), contacts[j].node[0], finest));
      a.block<3, 3>(3 * i, 3 * j) = reference.compliance(finest).block<3, 3>(3 * row, 3 * column);
    }
  }
  return a;
}

// plain fixed point iteration of the natural map, with a step below that of every eigenvalue: slow and sure
VectorXd iterate(const MatrixXd& a, const std::vector<UnilateralContact>& contacts, int iterations) {
  VectorXd f = VectorXd::Zero(a.rows());
  const double step = 1 / a.norm();
  VectorXd value(a.rows());
  for (std::size_t i = 0; i < contacts.size(); ++i) value.segment<3>(3 * static_cast<Index>(i)) = value_of(contacts[i]);
  for (int k = 0; k < iterations; ++k) {
    const VectorXd gap = a * f - value;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const auto at = 3 * static_cast<Index>(i);
      const Vector3d n = normal_of(contacts[i]).normalized();
      const Vector3d r = gap.segment<3>(at);
      const double sliding = (r - r.dot(n) * n).norm();
      const double friction = contacts[i].friction;
      f.segment<3>(at) = project(friction, n, f.segment<3>(at) - step * (r + friction * sliding * n));
    }
  }
  return f;
}

void check_laws(std::span<const UnilateralContact> contacts, const PushedBody& body) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vector3d n = normal_of(contacts[i]).normalized();
    const Vector3d f = body.force(i);
    const double pressed = f.dot(n);
    CHECK(pressed >= 0);
    CHECK((f - pressed * n).norm() <= (contacts[i].friction + 0x1p-22) * pressed);
    CHECK((body.state()[i] == ContactState::open) == (pressed == 0));
  }
}

constexpr Elastostatic::Limits limits{.max_contacts = 24, .cached_factors = 4, .iterations = 200};

TEST_CASE("forces of unilateral contacts are those of a plain iteration in double precision") {
  const ModelData data = synthetic_model({.levels = 3});
  const TestModel model(encode(data));
  const DenseReference reference(data);
  for (const double friction : {0.0, 0.3, 1.0}) {
    for (const double drag : {0.0, 2e-4, 2e-3}) {
      CAPTURE(friction);
      CAPTURE(drag);
      PushedBody body(model, limits);
      const auto contacts = pushed_patch(model, 24, 1e-3, drag, friction);
      const auto report = body.step(contacts);
      REQUIRE(report.status == Status::ok);
      MESSAGE("friction ", friction, ", drag ", drag, " m: ", report.iterations, " iterations, residual ",
              report.residual);
      CHECK(report.residual <= 1e-3);
      const VectorXd force = iterate(compliance_of(model, reference, contacts), contacts, 40000);
      double off = 0;
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        off = std::max(off, (body.force(i) - force.segment<3>(3 * static_cast<Index>(i))).cwiseAbs().maxCoeff());
      }
      CHECK(off <= 3e-3 * force.cwiseAbs().maxCoeff());
      check_laws(contacts, body);
      CHECK(std::ranges::count(body.state(), ContactState::open) > 0);
      CHECK(std::ranges::count(body.state(), ContactState::open) < 24);
      if (friction < 1) CHECK(std::ranges::count(body.state(), ContactState::slip) > 0);
    }
  }
}

TEST_CASE("contacts that stick and all press are held ones") {
  const TestModel model({.levels = 3});
  auto contacts = pushed_patch(model, 6, 1e-3, 0, 1e4);
  std::vector<Constraint> holds;
  for (UnilateralContact& contact : contacts) {
    for (int r = 0; r < 3; ++r) contact.value[r] = -1e-3F * node_record(model.view(), contact.node[0]).position[r];
    holds.push_back({contact.node[0], {contact.value[0], contact.value[1], contact.value[2]}});
  }
  PushedBody body(model, limits);
  REQUIRE(body.step(contacts).status == Status::ok);
  TestBody held(model, limits);
  REQUIRE(held.step(holds).status == Status::ok);
  double largest = 0, off = 0;
  for (std::size_t i = 0; i < body.force().size(); ++i) {
    largest = std::max(largest, std::abs(double{held.force()[i]}));
    off = std::max(off, std::abs(double{held.force()[i]} - body.force()[i]));
  }
  CHECK(off <= 2e-3 * largest);
  CHECK(std::ranges::count(body.state(), ContactState::stick) == 6);
}

TEST_CASE("whatever the budget, every answer obeys the laws and holds the budget") {
  for (const auto wavelet : {layout::Wavelet::lifted_linear, layout::Wavelet::equilibrated}) {
    const TestModel model({.levels = 4, .wavelet = wavelet});
    PushedBody body(model, limits);
    const std::uint64_t least = body.requirement().least_work;
    const std::uint64_t worst = body.requirement().worst_work[model.view().levels - 1];
    CHECK(least < worst);
    std::uint32_t finest = 0;
    std::mt19937_64 random(3);
    for (int cycle = 0; cycle < 400; ++cycle) {
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;
      const auto budget = least + static_cast<std::uint64_t>(share * share * static_cast<double>(worst - least));
      const auto contacts = pushed_patch(model, 2 + random() % 23, 1e-3 * share, 1e-3 * std::sin(0.1 * cycle), 0.4,
                                         static_cast<std::size_t>(cycle / 20));
      const auto report = body.step(contacts, budget);
      CAPTURE(cycle);
      CAPTURE(static_cast<int>(report.status));
      REQUIRE(answered(report.status));
      CHECK(report.work <= budget);
      check_laws(contacts, body);
      finest = std::max(finest, report.constraint_level);
    }
    PushedBody cold(model, limits);
    const auto contacts = pushed_patch(model, 24, 1e-3, 0, 0.4);
    const auto report = cold.step(contacts, least);
    REQUIRE(answered(report.status));
    check_laws(contacts, cold);
    CHECK(finest == model.view().levels - 1);
    CHECK(report.constraint_level < finest);
  }
}

TEST_CASE("the field is that of the forces, and contacts that touch stand on their surfaces") {
  const TestModel model({.levels = 3});
  PushedBody body(model, limits);
  const auto contacts = pushed_patch(model, 24, 1e-3, 0, 0.2);
  REQUIRE(body.step(contacts).status == Status::ok);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double gap = (body.displacement(contacts[i].node[0]) - value_of(contacts[i])).dot(normal_of(contacts[i]));
    CHECK(gap >= -1e-6);
    if (body.state()[i] != ContactState::open) CHECK(gap <= 1e-6);
  }
}

TEST_CASE("a surface without a unit normal, with negative friction or without a place is refused by name") {
  const TestModel model({.levels = 3});
  PushedBody body(model, limits);
  const auto good = pushed_patch(model, 5, 1e-3, 0, 0.2);
  const auto refused = [&](auto change, Status status) {
    auto contacts = good;
    change(contacts[3]);
    const auto report = body.step(contacts);
    CHECK(report.status == status);
    CHECK(report.refused == 3);
  };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  refused([](UnilateralContact& c) { c.normal[0] *= 1.1F, c.normal[1] *= 1.1F, c.normal[2] *= 1.1F; },
          Status::held_bad_surface);
  refused([](UnilateralContact& c) { c.friction = -0.1F; }, Status::held_bad_surface);
  refused([](UnilateralContact& c) { c.friction = nan; }, Status::held_not_finite);
  refused([](UnilateralContact& c) { c.normal[1] = nan; }, Status::held_not_finite);
  refused([](UnilateralContact& c) { c.value[1] = nan; }, Status::held_not_finite);
  refused([](UnilateralContact& c) { c.node[0] = 1 << 20; }, Status::held_out_of_range);
  refused([](UnilateralContact& c) { c.softness = -1; }, Status::held_bad_surface);
  refused([](UnilateralContact& c) { c.weight[0] = 1.1F; }, Status::held_bad_surface);
  refused([](UnilateralContact& c) { c.weight[0] = 0; }, Status::held_bad_surface);
  refused([](UnilateralContact& c) { c.node[0] = UnilateralContact::none; }, Status::held_bad_surface);
  refused([](UnilateralContact& c) { c.force[2] = nan; }, Status::held_not_finite);
  auto far = good;
  far[3].value[0] = 1e30F;
  CHECK(body.step(far).status == Status::held_unsolved);
  PushedBody holds_only(model, {.max_contacts = 8});
  CHECK(holds_only.step(good).status == Status::held_unsupported);
  CHECK(body.step(good).status == Status::ok);
}

}  // namespace
}  // namespace greenloop
