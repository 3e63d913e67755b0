// What is asked for beside the steps, against fields and dense solutions in double precision.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "runtime/stiffness.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wrench.hpp"

namespace greenloop {
namespace {

using Kind = Constraint::Kind;

constexpr Elastostatic::Limits limits{
    .max_contacts = 12, .cached_factors = 4, .max_forces = 8, .model_loads = true, .max_points = 6};

SyntheticOptions loaded(layout::Wavelet kind) { return {.levels = 4, .wavelet = kind, .gravity = true}; }

MeshPoint random_point(const ModelView& view, std::mt19937_64& random) {
  const auto node = [&] { return static_cast<std::uint32_t>(random() % view.node_count); };
  return {{node(), node(), node()}, {0.5F, 0.3F, 0.2F}};
}

float largest(std::span<const float> values) {
  float most = 0;
  for (const float value : values) most = std::max(most, std::abs(value));
  return most;
}

void check_points(TestBody& body, const std::vector<MeshPoint>& points) {
  std::vector<Vec3> moved(points.size());
  const std::uint64_t work = body.body().displacements(points, moved);
  CHECK(work > 0);
  CHECK(work <= body.requirement().selected_work);
  const float tolerance = 2e-5F * largest(body.field());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float of_point[] = {moved[i].x, moved[i].y, moved[i].z};
    for (std::size_t r = 0; r < 3; ++r) {
      float of_field = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        of_field += points[i].weight[k] * body.field()[std::size_t{4} * points[i].node[k] + r];
      }
      CHECK(std::abs(of_point[r] - of_field) <= tolerance);
    }
  }
}

TEST_CASE("points are displaced as the whole field has them, whatever acts and at whatever level") {
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(static_cast<std::uint32_t>(kind));
    const TestModel model(loaded(kind));
    TestBody body(model, limits);
    std::mt19937_64 random(2);
    std::uint32_t levels_seen = 0;
    for (std::size_t trial = 0; trial < 24; ++trial) {
      auto constraints = patch(model, 5 * trial, trial % 13);
      const auto free = patch(model, 5 * trial + 13, trial % 5);
      for (const Constraint& at : free) constraints.push_back({at.node, {1e-2F, 0, -1e-2F}, Kind::force});
      Elastostatic::Loads loads;
      if (trial % 3 == 1) loads.gravity = {0, -9.81F, 2};
      loads.stiffness = trial % 4 == 3 ? 0.3F : 1.0F;
      const std::uint64_t budget =
          trial % 2 == 0 ? any_budget : body.requirement().least_work + body.requirement().worst_work[3] / 8;
      const Elastostatic::StepReport report = body.step(constraints, loads, budget, true);
      REQUIRE(answered(report.status));
      levels_seen |= 1U << report.constraint_level;
      if (report.field_level + 1 < model.view().levels) continue;
      std::vector<MeshPoint> points;
      for (std::size_t i = 0; i < 1 + trial % 6; ++i) points.push_back(random_point(model.view(), random));
      check_points(body, points);
    }
    CHECK(levels_seen > 8U);
  }
}

TEST_CASE("a question changes nothing of what steps answer") {
  const TestModel model(loaded(layout::Wavelet::equilibrated));
  TestBody asked(model, limits), silent(model, limits);
  std::mt19937_64 random(9);
  std::vector<Vec3> moved(3);
  float block[9];
  const std::uint32_t nodes[] = {model.touchable()[3], model.touchable()[4]};
  const float halves[] = {0.5F, 0.5F};
  for (std::size_t trial = 0; trial < 60; ++trial) {
    const auto contacts = patch(model, trial / 4, 8);
    const Elastostatic::Loads loads{.gravity = {0, 0, trial % 5 == 0 ? 1.0F : 0.0F}};
    const std::uint64_t budget = asked.requirement().least_work + random() % asked.requirement().worst_work[3];
    const Elastostatic::StepReport report = asked.step(contacts, loads, budget, trial % 3 != 0);
    CHECK(report.work == silent.step(contacts, loads, budget, trial % 3 != 0).work);
    CHECK(std::equal(asked.force().begin(), asked.force().end(), silent.force().begin()));
    CHECK(std::equal(asked.field().begin(), asked.field().end(), silent.field().begin()));
    const std::vector<MeshPoint> points(3, random_point(model.view(), random));
    CHECK(asked.body().displacements(points, moved) > 0);
    CHECK(asked.body().masked_compliance(nodes[0], {nodes, halves}, block) > 0);
  }
}

TEST_CASE("the compliance of a mask is the sum of its nodes' by their parts") {
  for (const layout::Wavelet kind : layout::wavelets) {
    const ModelData data = synthetic_model(loaded(kind));
    const TestModel model(encode(data));
    const DenseReference reference(data);
    const Eigen::MatrixXd& compliance = reference.compliance(model.view().levels - 1);
    TestBody body(model, limits);
    const auto nodes = model.touchable();
    const std::uint32_t masked[] = {nodes[9], nodes[30], nodes[31], nodes[9]};
    const float weight[] = {0.5F, 0.25F, 0.125F, 0.125F};
    for (const std::uint32_t node : {nodes[9], nodes[0], nodes.back()}) {
      float block[9];
      const std::uint64_t work = body.body().masked_compliance(node, {masked, weight}, block);
      CHECK(work > 0);
      CHECK(work <= body.requirement().selected_work);
      Eigen::Matrix3d exact = Eigen::Matrix3d::Zero();
      const auto place = [&](std::uint32_t of) { return Eigen::Index{3} * domain_place(model.view(), of); };
      for (std::size_t k = 0; k < 4; ++k) {
        exact += double{weight[k]} * compliance.block<3, 3>(place(node), place(masked[k]));
      }
      for (Eigen::Index k = 0; k < 9; ++k) {
        CHECK(std::abs(double{block[k]} - exact(k % 3, k / 3)) <= 1e-5 * exact.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST_CASE("the stiffness of a point is the mean of its corners', rigid where they are held, and capped") {
  const TestModel model(loaded(layout::Wavelet::linear));
  TestBody body(model, limits);
  const auto nodes = model.touchable();
  std::uint32_t fixed = 0;
  while (in_domain(model.view(), fixed)) ++fixed;
  const float whole[] = {1};
  const Mask masks[] = {{std::span(nodes).subspan(4, 1), whole}, {std::span(nodes).subspan(11, 1), whole}, {}};
  float corner[2][9], k[9];
  for (std::size_t i = 0; i < 2; ++i) {
    float block[9];
    REQUIRE(body.body().masked_compliance(masks[i].node[0], masks[i], block) > 0);
    REQUIRE(invert_compliance(block, corner[i]));
    const Eigen::Map<const Eigen::Matrix3f> compliance(block), stiffness(corner[i]);
    CHECK((compliance * stiffness - Eigen::Matrix3f::Identity()).norm() < 1e-5);
  }
  const MeshPoint point{{nodes[4], nodes[11], fixed}, {0.5F, 0.25F, 0.25F}};
  const float rigid = 10 * stiffness_norm(corner[0]);
  REQUIRE(body.body().stiffness(point, masks, rigid, false, k) > 0);
  for (std::size_t e = 0; e < 9; ++e) {
    const float of_fixed = e % 4 == 0 ? rigid : 0;
    CHECK(k[e] == doctest::Approx(0.5F * corner[0][e] + 0.25F * corner[1][e] + 0.25F * of_fixed));
  }
  const float soft = 0.1F * stiffness_norm(corner[0]) / std::sqrt(3.0F);
  REQUIRE(body.body().stiffness({{nodes[4], nodes[4], nodes[4]}, {1, 0, 0}}, masks, soft, true, k) > 0);
  for (std::size_t e = 0; e < 9; ++e) CHECK(k[e] == doctest::Approx(0.1F * corner[0][e]));
  CHECK(stiffness_norm(k) == doctest::Approx(std::sqrt(3.0F) * soft));
}

TEST_CASE("a point takes a fraction of the field, and less than twice as much with four times the nodes") {
  std::uint64_t points[2] = {}, fields[2] = {};
  for (const std::uint32_t finer : {0U, 1U}) {
    const TestModel model({.levels = 4 + finer});
    TestBody body(model, limits);
    const std::uint32_t node = model.touchable().front();
    const std::vector<Constraint> held = {{node, {1e-3F, 0, 0}}};
    fields[finer] = body.step(held).work;
    fields[finer] -= body.step(held, any_budget, false).work;
    Vec3 moved;
    const MeshPoint point = at_node(node);
    points[finer] = body.body().displacements({&point, 1}, {&moved, 1});
    CHECK(moved.x == doctest::Approx(1e-3));
    MESSAGE(model.view().node_count, " nodes: units of a point ", points[finer], ", of the field ", fields[finer]);
  }
  CHECK(points[1] < 2 * points[0]);
  CHECK(4 * points[0] < fields[0]);
  CHECK(4 * points[1] < fields[1]);
}

TEST_CASE("what cannot be answered is refused, and nothing is written") {
  const TestModel model(loaded(layout::Wavelet::linear));
  TestBody body(model, limits);
  TestBody lean(model, {.max_contacts = 2, .cached_factors = 1});
  CHECK(lean.requirement().selected_work == 0);
  const auto nodes = model.touchable();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3> moved(7, {4, 5, 6});
  const auto ask = [&](TestBody& of, const std::vector<MeshPoint>& points) {
    return of.body().displacements(points, std::span(moved).first(points.size()));
  };
  CHECK(ask(body, {at_node(nodes[0])}) == 0);  // no answer yet
  REQUIRE(body.step(patch(model, 0, 2)).status == Status::ok);
  REQUIRE(lean.step(patch(model, 0, 2)).status == Status::ok);
  CHECK(ask(lean, {at_node(nodes[0])}) == 0);
  CHECK(ask(body, {at_node(model.view().node_count)}) == 0);
  CHECK(ask(body, {{{nodes[0], nodes[0], nodes[0]}, {nan, 0, 0}}}) == 0);
  CHECK(ask(body, std::vector<MeshPoint>(7, at_node(nodes[0]))) == 0);
  CHECK(moved[0].x == 4);
  CHECK(ask(body, {at_node(nodes[0])}) > 0);
  CHECK(moved[0].x == doctest::Approx(body.field()[std::size_t{4} * nodes[0]]));
  body.step(std::vector<Constraint>{{nodes[0], {nan, 0, 0}}});
  CHECK(ask(body, {at_node(nodes[0])}) == 0);  // the last step was refused
  REQUIRE(body.step({}).status == Status::ok);
  CHECK(ask(body, {at_node(nodes[0])}) > 0);
  CHECK(moved[0].x == 0);
  std::uint32_t fixed = 0;
  while (in_domain(model.view(), fixed)) ++fixed;
  const float one[] = {1}, spoilt[] = {nan};
  const Mask mask{std::span(nodes).first(1), one};
  float block[9] = {7};
  CHECK(lean.body().masked_compliance(nodes[0], mask, block) == 0);
  CHECK(body.body().masked_compliance(fixed, mask, block) == 0);
  CHECK(body.body().masked_compliance(nodes[0], {}, block) == 0);
  CHECK(body.body().masked_compliance(nodes[0], {std::span(nodes).first(1), spoilt}, block) == 0);
  CHECK(body.body().masked_compliance(nodes[0], {std::span(&fixed, 1), one}, block) == 0);
  const std::vector<float> many(21, 1.0F);
  CHECK(body.body().masked_compliance(nodes[0], {std::span(nodes).first(21), many}, block) == 0);
  CHECK(block[0] == 7);
}

TEST_CASE("forces and torques about a point add up") {
  const Vec3 position[] = {{1, 0, 0}, {0, 2, 0}};
  const Vec3 force[] = {{0, 3, 0}, {0, 0, 5}};
  const Wrench wrench = total_wrench(position, force, {0, 0, 1});
  CHECK(wrench.force.x == 0);
  CHECK(wrench.force.y == 3);
  CHECK(wrench.force.z == 5);
  // (1, 0, -1) x (0, 3, 0) + (0, 2, -1) x (0, 0, 5)
  CHECK(wrench.torque.x == 3 + 10);
  CHECK(wrench.torque.y == 0);
  CHECK(wrench.torque.z == 3);
}

}  // namespace
}  // namespace greenloop
