#include "runtime/elastostatic/mixed_contacts.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Kind = Constraint::Kind;

float uniform(std::mt19937_64& random) { return static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F; }

Vec3 unit(std::mt19937_64& random) {
  const Vec3 v{uniform(random), uniform(random), uniform(random) + 0.01F};
  const float length = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / length, v.y / length, v.z / length};
}

Vec3 outward(const TestModel& model, std::uint32_t node) {
  const Vec3 x = model.model().position(node);
  const float length = std::sqrt(x.x * x.x + x.y * x.y + x.z * x.z);
  return {x.x / length, x.y / length, x.z / length};
}

// constraints and the masks that they name
struct Problem {
  std::vector<Constraint> constraints;
  std::vector<std::vector<float>> weights;
  std::vector<std::vector<Vec3>> parts;

  void hold(std::uint32_t node, std::vector<float> value, Kind kind = Kind::hold) {
    constraints.push_back({node, {value[0], value[1], value[2]}, kind});
  }
  void hold_mask(std::vector<std::uint32_t> of, std::vector<float> weight, std::vector<float> value,
                 Kind kind = Kind::mask) {
    hold(static_cast<std::uint32_t>(weights.size()), value, kind);
    scalar_nodes.push_back(std::move(of));
    weights.push_back(std::move(weight));
  }
  void hold_along(std::vector<std::uint32_t> of, std::vector<Vec3> part, float value, Kind kind = Kind::normal) {
    hold(static_cast<std::uint32_t>(parts.size()), {value, 0, 0}, kind);
    directed_nodes.push_back(std::move(of));
    parts.push_back(std::move(part));
  }
  // refers to this
  Elastostatic::Loads loads() {
    masks.clear();
    directed.clear();
    for (std::size_t i = 0; i < weights.size(); ++i) masks.push_back({scalar_nodes[i], weights[i]});
    for (std::size_t i = 0; i < parts.size(); ++i) directed.push_back({directed_nodes[i], parts[i]});
    Elastostatic::Loads loads;
    loads.masks = masks;
    loads.directed = directed;
    return loads;
  }

  std::vector<std::vector<std::uint32_t>> scalar_nodes, directed_nodes;
  std::vector<Mask> masks;
  std::vector<DirectedMask> directed;
};

struct Numbers {
  std::size_t holds, normals, masks, along, forces;
};

// of distinct nodes but for masks, which overlap anything; known forces are on nodes that are held along normals
Problem draw(const TestModel& model, std::mt19937_64& random, const Numbers& of) {
  std::vector<std::uint32_t> nodes = model.touchable();
  std::shuffle(nodes.begin(), nodes.end(), random);
  const auto displacement = [&] { return 1e-3F * uniform(random); };
  Problem problem;
  for (std::size_t i = 0; i < of.holds; ++i) problem.hold(nodes[i], {displacement(), displacement(), displacement()});
  for (std::size_t i = 0; i < of.normals; ++i) {
    const std::uint32_t node = nodes[of.holds + i];
    problem.hold_along({node}, {outward(model, node)}, displacement());
    if (i < of.forces) problem.hold(node, {uniform(random), uniform(random), uniform(random)}, Kind::force);
  }
  const auto some = [&] {
    std::vector<std::uint32_t> three;
    for (int k = 0; k < 3; ++k) three.push_back(nodes[random() % nodes.size()]);
    return three;
  };
  for (std::size_t i = 0; i < of.masks; ++i) {
    problem.hold_mask(some(), {0.5F, 0.3F, 0.2F}, {displacement(), displacement(), displacement()});
  }
  for (std::size_t i = 0; i < of.along; ++i) {
    problem.hold_along(some(), {unit(random), unit(random), unit(random)}, displacement());
  }
  for (std::size_t i = 0; i < of.forces; ++i) {
    problem.hold_along(some(), {unit(random), unit(random), unit(random)}, uniform(random), Kind::along);
  }
  std::shuffle(problem.constraints.begin(), problem.constraints.end(), random);
  return problem;
}

// the projected problem on dense matrices in double precision
class DenseMixed {
 public:
  DenseMixed(const TestModel& model, const DenseReference& reference, std::uint32_t level, Problem& problem,
             const Elastostatic::Loads& loads)
      : model_(model), level_(level), loads_(loads), facts_(model.view().node_count) {
    list_node_facts(model.view(), facts_.data());
    const MatrixXd& compliance = reference.compliance(level);
    const auto constraints = std::span<const Constraint>(problem.constraints);
    force = VectorXd::Zero(3 * static_cast<Index>(constraints.size()));
    VectorXd known = VectorXd::Zero(compliance.rows());
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      if (is_contact(constraints[i])) {
        join(constraints[i], i);
      } else {
        for (Index r = 0; r < (constraints[i].kind == Kind::along ? 1 : 3); ++r) {
          const auto value = double{constraints[i].value[r]};
          known += value * row_of(constraints[i], r);
          force(3 * static_cast<Index>(i) + r) = value;
        }
      }
    }
    const auto rows = static_cast<Index>(rows_.size());
    MatrixXd d(rows, compliance.cols());
    VectorXd value(rows);
    for (Index k = 0; k < rows; ++k) {
      const Row& row = rows_[static_cast<std::size_t>(k)];
      const auto members = static_cast<double>(row.members.size());
      d.row(k) = row.d.transpose() / members;
      value(k) = row.value / members;
    }
    const MatrixXd projected = d * compliance * d.transpose();
    const Eigen::JacobiSVD<MatrixXd> svd(projected);
    condition = svd.singularValues().maxCoeff() / svd.singularValues().minCoeff();
    const VectorXd amount = projected.fullPivLu().solve(value - d * compliance * known);
    for (Index k = 0; k < rows; ++k) {
      const Row& row = rows_[static_cast<std::size_t>(k)];
      for (const std::size_t i : row.members) {
        force(3 * static_cast<Index>(i) + row.axis) = amount(k) / static_cast<double>(row.members.size());
      }
    }
    field = reference.field(level) * (known + d.transpose() * amount);
  }

  VectorXd force;  // 3 a constraint
  VectorXd field;  // 3 a domain node
  double condition = 0;

 private:
  struct Row {
    VectorXd d;
    double value;
    Index axis;
    std::vector<std::size_t> members;
  };

  [[nodiscard]] Index place(std::uint32_t node) const {
    return Index{3} * column_place(column_of(model_.view(), facts_.data(), node, level_));
  }
  [[nodiscard]] VectorXd row_of(const Constraint& constraint, Index r) const {
    VectorXd d = VectorXd::Zero(Index{3} * domain_up_to(model_.view(), level_));
    if (constraint.kind == Kind::normal || constraint.kind == Kind::along) {
      const DirectedMask& mask = loads_.directed[constraint.node];
      for (std::size_t k = 0; k < mask.node.size(); ++k) {
        d.segment<3>(place(mask.node[k])) += Vector3d(mask.part[k].x, mask.part[k].y, mask.part[k].z);
      }
    } else if (constraint.kind == Kind::mask || constraint.kind == Kind::pattern) {
      const Mask& mask = loads_.masks[constraint.node];
      for (std::size_t k = 0; k < mask.node.size(); ++k) d(place(mask.node[k]) + r) += double{mask.weight[k]};
    } else {
      d(place(constraint.node) + r) = 1;
    }
    return d;
  }
  // contacts of single nodes that share a column below the finest level
  void join(const Constraint& constraint, std::size_t i) {
    const bool directed = constraint.kind == Kind::normal;
    const bool alone = constraint.kind == Kind::hold || (directed && loads_.directed[constraint.node].node.size() == 1);
    const bool shares = alone && level_ + 1 < model_.view().levels;
    const std::uint32_t node = constraint.kind == Kind::hold ? constraint.node
                               : directed                    ? loads_.directed[constraint.node].node[0]
                                                             : 0;
    for (Index r = 0; r < (directed ? 1 : 3); ++r) {
      const VectorXd d = row_of(constraint, r);
      const auto key = std::make_pair(alone ? place(node) : Index{-1}, directed ? Index{3} : r);
      const auto found = shares ? of_column_.find(key) : of_column_.end();
      if (found != of_column_.end()) {
        Row& row = rows_[found->second];
        row.d += d;
        row.value += double{constraint.value[r]};
        row.members.push_back(i);
        continue;
      }
      if (shares) of_column_[key] = rows_.size();
      rows_.push_back({d, double{constraint.value[r]}, r, {i}});
    }
  }

  const TestModel& model_;
  std::uint32_t level_;
  const Elastostatic::Loads& loads_;
  std::vector<NodeFacts> facts_;
  std::vector<Row> rows_;
  std::map<std::pair<Index, Index>, std::size_t> of_column_;
};

constexpr Elastostatic::Limits limits{
    .max_contacts = 24, .cached_factors = 4, .max_forces = 24, .mixed_contacts = true};

double relative_error(std::span<const float> computed, const VectorXd& reference) {
  double error = 0;
  for (Index i = 0; i < reference.size(); ++i) {
    error = std::max(error, std::abs(double{computed[static_cast<std::size_t>(i)]} - reference(i)));
  }
  return error / reference.cwiseAbs().maxCoeff();
}

// of the domain
double field_error(const TestModel& model, std::span<const float> field, const VectorXd& reference) {
  double error = 0;
  for (std::uint32_t node = 0; node < model.view().node_count; ++node) {
    if (!in_domain(model.view(), node)) continue;
    for (Index r = 0; r < 3; ++r) {
      const double exact = reference(Index{3} * domain_place(model.view(), node) + r);
      error = std::max(error, std::abs(field[4 * std::size_t{node} + static_cast<std::size_t>(r)] - exact));
    }
  }
  return error / reference.cwiseAbs().maxCoeff();
}

// float rounding of the matrix, the factors and the sums, amplified by the condition
double tolerance_of(const DenseMixed& dense) { return 60 * dense.condition * 0x1p-24; }

Vector3d force_of(const TestBody& body, std::size_t i) {
  return {body.force()[3 * i], body.force()[3 * i + 1], body.force()[3 * i + 2]};
}

Vector3d moved(const TestBody& body, std::uint32_t node) {
  const std::span<const float> u = body.field();
  return {u[4 * std::size_t{node}], u[4 * std::size_t{node} + 1], u[4 * std::size_t{node} + 2]};
}

TEST_CASE("nodes and masks, held in all directions or in some, agree with a dense solution at every level") {
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(static_cast<std::uint32_t>(kind));
    const ModelData data = synthetic_model({.levels = 4, .wavelet = kind});
    const TestModel model(encode(data));
    const DenseReference reference(data);
    std::mt19937_64 random(5);
    std::uint32_t levels_seen = 0;
    Elastostatic::Limits tight = limits;  // a body for more could not be starved by so few
    tight.max_contacts = 18;
    TestBody body(model, tight);
    for (std::size_t trial = 0; trial < 40; ++trial) {
      Problem problem = draw(model, random, {trial % 4, 1 + trial % 7, trial % 3, trial % 2, trial % 4});
      const Elastostatic::Loads loads = problem.loads();
      const auto wanted = static_cast<std::uint32_t>(trial) % model.view().levels;
      body.renew();
      Elastostatic::StepReport report = body.step(problem.constraints, loads, any_budget, true);
      while (answered(report.status) && report.constraint_level > wanted &&
             report.work > body.requirement().least_work) {
        const std::uint64_t budget = std::max(report.work - report.work / 4, body.requirement().least_work);
        body.renew();
        report = body.step(problem.constraints, loads, budget, true);
      }
      CAPTURE(trial);
      REQUIRE(answered(report.status));
      const DenseMixed dense(model, reference, report.constraint_level, problem, loads);
      if (report.constraint_level + 1 < model.view().levels && dense.condition > 1000) continue;  // rows are left out
      levels_seen |= 1U << report.constraint_level;
      CHECK(relative_error(body.force(), dense.force) <= tolerance_of(dense));
      if (report.field_level + 1 == model.view().levels) {
        CHECK(field_error(model, body.field(), dense.field) <= tolerance_of(dense));
      }
    }
    CHECK(levels_seen > 1U << (model.view().levels - 1));  // the finest one, and a coarser one at least
  }
}

TEST_CASE("a node that is held along its normal slides freely, and under a tangential force by what that does") {
  const TestModel model({.levels = 4});
  TestBody body(model, limits);
  const std::uint32_t node = model.touchable()[20];
  const Vec3 n = outward(model, node);
  const Vector3d normal(n.x, n.y, n.z);
  const Vector3d across = 0.5 * normal.unitOrthogonal();
  Problem problem;
  problem.hold_along({node}, {n}, -1e-3F);
  REQUIRE(body.step(problem.constraints, problem.loads(), any_budget, true).status == Status::ok);
  const Vector3d free = moved(body, node);
  const float pushed = body.force()[0];
  CHECK(pushed < 0);
  CHECK(free.dot(normal) == doctest::Approx(-1e-3).epsilon(1e-4));
  CHECK((free - free.dot(normal) * normal).norm() > 1e-5);
  // it takes less than holding all directions
  TestBody bonded(model, limits);
  const std::vector<Constraint> held = {{node, {-1e-3F * n.x, -1e-3F * n.y, -1e-3F * n.z}}};
  REQUIRE(bonded.step(held).status == Status::ok);
  CHECK(std::abs(pushed) < -force_of(bonded, 0).dot(normal));
  problem.hold(node, {static_cast<float>(across(0)), static_cast<float>(across(1)), static_cast<float>(across(2))},
               Kind::force);
  REQUIRE(body.step(problem.constraints, problem.loads(), any_budget, true).status == Status::ok);
  const Vector3d rubbed = moved(body, node);
  CHECK(rubbed.dot(normal) == doctest::Approx(-1e-3).epsilon(1e-4));
  CHECK((rubbed - free).dot(across) > 0);
  CHECK(force_of(body, 1) == across.cast<float>().cast<double>());
}

TEST_CASE("a held mask stands in the mean, and a torque turns it") {
  const TestModel model({.levels = 4});
  TestBody body(model, limits);
  const auto nodes = model.touchable();
  const std::vector<std::uint32_t> masked(nodes.begin() + 30, nodes.begin() + 36);
  const std::vector<float> weight = {0.3F, 0.2F, 0.2F, 0.1F, 0.1F, 0.1F};
  Problem problem;
  problem.hold_mask(masked, weight, {1e-3F, 0, -2e-3F});
  std::vector<Vec3> part(6);
  const Vec3 axis = outward(model, masked[0]);
  const DirectedMask torque = make_torque_mask(model.model(), {masked, weight}, axis, part);
  REQUIRE(torque.part.size() == 6);
  problem.hold_along(masked, part, 0.01F);
  REQUIRE(body.step(problem.constraints, problem.loads(), any_budget, true).status == Status::ok);
  Vector3d mean = Vector3d::Zero(), sum = Vector3d::Zero();
  double turn = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    const Vector3d u = moved(body, masked[k]), p(part[k].x, part[k].y, part[k].z);
    mean += double{weight[k]} * u;
    turn += p.dot(u);
    sum += p;
  }
  CHECK((mean - Vector3d(1e-3, 0, -2e-3)).norm() <= 1e-6);
  CHECK(turn == doctest::Approx(0.01).epsilon(1e-3));
  CHECK(sum.norm() <= 1e-4 * Vector3d(part[0].x, part[0].y, part[0].z).norm());
  CHECK(body.force()[3] > 0);
  CHECK(body.force()[4] == 0);
  // along one of its directions alone it is held by a directed mask
  std::vector<Vec3> along(6);
  const DirectedMask directed = direct_mask({masked, weight}, {0, 0, 1}, along);
  Problem sliding;
  sliding.hold_along(masked, {directed.part.begin(), directed.part.end()}, -2e-3F);
  REQUIRE(body.step(sliding.constraints, sliding.loads(), any_budget, true).status == Status::ok);
  double height = 0;
  for (std::size_t k = 0; k < 6; ++k) height += double{weight[k]} * moved(body, masked[k]).z();
  CHECK(height == doctest::Approx(-2e-3).epsilon(1e-4));
}

TEST_CASE("holds alone are answered as by a body that knows no others; directions may turn on a cached factor") {
  const TestModel model({.levels = 4});
  TestBody body(model, limits);
  Elastostatic::Limits plain = limits;
  plain.mixed_contacts = false;
  plain.keep_capacitance = true;
  TestBody lean(model, plain);
  CHECK(body.requirement().bytes > lean.requirement().bytes);
  CHECK(body.requirement().least_work > lean.requirement().least_work);
  for (std::size_t trial = 0; trial < 20; ++trial) {
    const auto contacts = patch(model, 3 * trial, 1 + trial % 12);
    CHECK(body.step(contacts).work == lean.step(contacts).work);
    CHECK(std::equal(body.force().begin(), body.force().end(), lean.force().begin()));
    CHECK(std::equal(body.field().begin(), body.field().end(), lean.field().begin()));
  }
  std::mt19937_64 random(7);
  for (int cycle = 0; cycle < 5; ++cycle) {
    Problem problem;
    for (std::size_t i = 100; i < 110; ++i) problem.hold_along({model.touchable()[i]}, {unit(random)}, 1e-3F);
    const auto report = body.step(problem.constraints, problem.loads(), any_budget, true);
    REQUIRE(report.status == Status::ok);
    CHECK(report.details.cached_factor == (cycle > 0));
  }
}

TEST_CASE("whatever the budget, mixed contacts are answered within it, by forces of their own size") {
  for (const auto wavelet : {layout::Wavelet::lifted_linear, layout::Wavelet::equilibrated}) {
    const TestModel model({.levels = 4, .wavelet = wavelet});
    TestBody body(model, limits), twin(model, limits);
    const std::uint64_t least = body.requirement().least_work;
    const std::uint64_t worst = body.requirement().worst_work[3];
    std::mt19937_64 random(9);
    std::uint32_t levels_seen = 0;
    for (std::size_t cycle = 0; cycle < 300; ++cycle) {
      Problem problem = draw(model, random, {random() % 4, random() % 8, 1 + random() % 2, random() % 2, random() % 4});
      const Elastostatic::Loads loads = problem.loads();
      const std::uint64_t budget = cycle % 3 == 0 ? least : least + random() % (worst - least);
      const auto report = body.step(problem.constraints, loads, budget, random() % 4 != 0);
      CAPTURE(cycle);
      REQUIRE(answered(report.status));
      CHECK(report.work <= budget);
      CHECK(report.work <= body.requirement().worst_work[report.constraint_level]);
      CHECK(report.details.needed_work <= budget);
      levels_seen |= 1U << report.constraint_level;
    }
    CHECK(levels_seen > 1U << 3);
    // many along alike normals, at the least budget: what depends on others does not blow up
    Problem alike;
    for (std::size_t i = 0; i < 24; ++i)
      alike.hold_along({model.touchable()[i]}, {outward(model, model.touchable()[i])}, i % 2 == 0 ? -1e-3F : -9e-4F);
    double largest[2] = {};
    for (const bool rich : {false, true}) {
      twin.renew();
      const auto report = twin.step(alike.constraints, alike.loads(), rich ? any_budget : least, true);
      CHECK((report.constraint_level == 3) == rich);
      for (const float f : twin.force()) largest[rich ? 1 : 0] = std::max(largest[rich ? 1 : 0], std::abs(double{f}));
    }
    CHECK(largest[0] <= 2 * largest[1]);
  }
}

TEST_CASE("from a coarser level to the finest the forces of mixed contacts glide") {
  const TestModel model({.levels = 4});
  TestBody body(model, limits);
  std::mt19937_64 random(11);
  Problem problem = draw(model, random, {2, 5, 2, 1, 0});
  const Elastostatic::Loads loads = problem.loads();
  body.step(problem.constraints, loads, body.requirement().least_work, false);
  std::vector<float> last(body.force().begin(), body.force().end());
  std::uint32_t glides = 0;
  Elastostatic::StepReport report;
  for (std::uint32_t cycle = 0; cycle < 40 && (cycle == 0 || report.status != Status::ok); ++cycle) {
    report = body.step(problem.constraints, loads, any_budget, false);
    REQUIRE(answered(report.status));
    for (std::size_t i = 0; i < last.size(); ++i) {
      CHECK(std::abs(body.force()[i] - last[i]) <=
            1.001F * report.details.level_difference / static_cast<float>(limits.glide_cycles) + 1e-6F);
    }
    last.assign(body.force().begin(), body.force().end());
    glides += report.details.glide < 1 ? 1 : 0;
  }
  CHECK(report.status == Status::ok);
  CHECK(glides == limits.glide_cycles - 1);
  TestBody fresh(model, limits);
  fresh.step(problem.constraints, loads, any_budget, false);
  for (std::size_t i = 0; i < last.size(); ++i) CHECK(last[i] == doctest::Approx(fresh.force()[i]).epsilon(1e-4));
}

TEST_CASE("what is wrong with mixed contacts is refused by name") {
  const TestModel model({.levels = 3, .touchable_above = 0.0});
  const auto nodes = model.touchable();
  std::uint32_t untouchable = 0;
  while (model.model().is_touchable(untouchable)) ++untouchable;
  Elastostatic::Limits few = limits;
  few.max_contacts = 4;
  few.max_forces = 0;
  TestBody body(model, few);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Vec3 up{0, 0, 1};
  const auto refused = [&](auto&& add) {
    Problem problem;
    add(problem);
    return body.step(problem.constraints, problem.loads(), any_budget, true).status;
  };
  CHECK(refused([&](Problem& p) { p.hold_along({nodes[0]}, {up}, 1e-3F); }) == Status::ok);
  const std::vector<float> before(body.field().begin(), body.field().end());
  CHECK(refused([&](Problem& p) { p.hold(0, {1, 0, 0}, Kind::normal); }) == Status::held_out_of_range);
  CHECK(refused([&](Problem& p) { p.hold(0, {1, 0, 0}, Kind::mask); }) == Status::held_out_of_range);
  CHECK(refused([&](Problem& p) { p.hold_along({nodes[0]}, {{nan, 0, 0}}, 1); }) == Status::held_not_finite);
  CHECK(refused([&](Problem& p) { p.hold_along({nodes[0]}, {up}, nan); }) == Status::held_not_finite);
  CHECK(refused([&](Problem& p) { p.hold_along({nodes[0]}, {up, up}, 1); }) == Status::held_out_of_range);
  CHECK(refused([&](Problem& p) { p.hold_along({untouchable}, {up}, 1); }) == Status::held_not_touchable);
  CHECK(refused([&](Problem& p) { p.hold_along({}, {}, 1); }) == Status::held_out_of_range);
  CHECK(refused([&](Problem& p) { p.hold_along({nodes[0]}, {up}, 1, Kind::along); }) == Status::held_unsupported);
  CHECK(refused([&](Problem& p) {
          p.hold_mask({nodes[0], nodes[1], nodes[2], nodes[3], nodes[4]}, std::vector<float>(5, 0.2F), {0, 0, 0});
        }) == Status::held_out_of_range);
  // one that the others leave nothing of
  CHECK(refused([&](Problem& p) {
          p.hold_along({nodes[0]}, {up}, 1e-3F);
          p.hold_along({nodes[0]}, {up}, 1e-3F);
        }) == Status::held_singular);
  CHECK(refused([&](Problem& p) {
          p.hold(nodes[0], {0, 0, 0});
          p.hold_mask({nodes[0], nodes[0]}, {0.5F, 0.5F}, {0, 0, 0});
        }) == Status::held_singular);
  CHECK(refused([&](Problem& p) { p.hold_along({nodes[0]}, {{0, 0, 0}}, 1e-3F); }) == Status::held_singular);
  CHECK(refused([&](Problem& p) { p.hold_along({nodes[0]}, {up}, 1e38F); }) == Status::held_overflow);
  CHECK(std::equal(before.begin(), before.end(), body.field().begin()));
  Elastostatic::Limits plain = few;
  plain.mixed_contacts = false;
  TestBody lean(model, plain);
  Problem problem;
  problem.hold_along({nodes[0]}, {up}, 1e-3F);
  CHECK(lean.step(problem.constraints, problem.loads(), any_budget, true).status == Status::held_unsupported);
}

}  // namespace
}  // namespace greenloop
