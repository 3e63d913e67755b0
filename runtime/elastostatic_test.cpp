#include "runtime/elastostatic.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

std::vector<Constraint> random_contacts(std::mt19937_64& random, std::vector<std::uint32_t> nodes, std::size_t count) {
  std::vector<Constraint> contacts;
  for (std::size_t i = 0; i < std::min(count, nodes.size()); ++i) {
    std::swap(nodes[i], nodes[i + random() % (nodes.size() - i)]);
    Constraint contact{nodes[i], {}};
    for (float& u : contact.value) {
      u = (static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F) * 1e-3F;
    }
    contacts.push_back(contact);
  }
  return contacts;
}

double relative_error(std::span<const float> computed, std::size_t stride, const Eigen::VectorXd& reference) {
  double error = 0;
  for (Eigen::Index i = 0; i < reference.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    error = std::max(error, std::abs(computed[k / 3 * stride + k % 3] - reference(i)));
  }
  return error / reference.cwiseAbs().maxCoeff();
}

// float rounding of the matrix, the factors and the sums, amplified by the condition
double tolerance_of(const DenseAnswer& dense) { return 60 * dense.condition * 0x1p-24; }

TEST_CASE("every constraint level agrees with a dense double-precision solution of what the file stands for") {
  for (const auto& options :
       {SyntheticOptions{.levels = 4, .epsilon = 0}, SyntheticOptions{.levels = 4},
        SyntheticOptions{.levels = 5, .touchable_above = 0.5},
        SyntheticOptions{.levels = 4, .wavelet = layout::Wavelet::linear},
        SyntheticOptions{.levels = 4, .wavelet = layout::Wavelet::lifted_butterfly},
        SyntheticOptions{.levels = 4, .wavelet = layout::Wavelet::butterfly},
        SyntheticOptions{.levels = 4, .wavelet = layout::Wavelet::equilibrated}, SyntheticOptions{.levels = 3},
        SyntheticOptions{.levels = 2, .quantum = 0}, SyntheticOptions{.levels = 1},
        SyntheticOptions{.levels = 1, .wavelet = layout::Wavelet::equilibrated}}) {
    const ModelData data = synthetic_model(options);
    const TestModel model(encode(data));
    CAPTURE(options.levels);
    const DenseReference reference(data);
    std::mt19937_64 random(7);
    std::uint32_t levels_seen = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const auto contacts = random_contacts(random, model.touchable(), 1 + random() % 20);
      // less and less work, down to the level that is wanted or to the least
      std::uint64_t budget = any_budget;
      Elastostatic::StepReport report;
      const std::uint32_t wanted = static_cast<std::uint32_t>(trial) % model.view().levels;
      TestBody body(model, {.max_contacts = 20, .cached_factors = 4});
      while (answered((report = body.step(contacts, budget)).status) && report.constraint_level > wanted &&
             report.work > body.requirement().least_work) {
        budget = std::max(report.work - report.work / 4, body.requirement().least_work);
        body = TestBody(model, {.max_contacts = 20, .cached_factors = 4});
      }
      REQUIRE(answered(report.status));
      const std::uint32_t c = report.constraint_level;
      levels_seen |= 1U << c;
      CAPTURE(c);
      const DenseAnswer dense = solve_dense(model.view(), reference, {c}, contacts);
      CHECK(relative_error(body.force(), 3, dense.force) <= tolerance_of(dense));
      if (report.field_level == model.view().levels - 1) {
        CHECK(relative_error(body.field(), 4, dense.displacement) <= tolerance_of(dense));
      }
    }
    MESSAGE("constraint levels seen, a bit each: ", levels_seen);
    CHECK((levels_seen & 1U << (model.view().levels - 1)) != 0);
  }
}

TEST_CASE("nothing dropped and 16 bits reproduce the exact compliance to quantisation error") {
  const TestModel model({.levels = 3, .epsilon = 0, .quantum = 0});
  const ModelView& view = model.view();
  TestBody body(model, {.max_contacts = 8, .cached_factors = 1});
  const auto position = [&view](std::uint32_t node) {
    const float* x = node_record(view, node).position;
    return Eigen::Vector3d(x[0], x[1], x[2]);
  };
  const auto compliance = [&](std::uint32_t i, std::uint32_t j) {
    return synthetic_compliance(position(i), position(j));
  };
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const auto contacts = random_contacts(random, model.touchable(), 8);
    REQUIRE(body.step(contacts, any_budget).status == Status::ok);
    const auto n = static_cast<Eigen::Index>(contacts.size());
    Eigen::MatrixXd a(3 * n, 3 * n);
    Eigen::VectorXd prescribed(3 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        a.block<3, 3>(3 * i, 3 * j) = compliance(contacts[i].node, contacts[j].node);
      }
      for (Eigen::Index r = 0; r < 3; ++r) {
        prescribed(3 * i + r) = contacts[i].value[r];
      }
    }
    const Eigen::VectorXd force = a.ldlt().solve(prescribed);
    const double condition = a.norm() * a.inverse().norm();
    // a scaled block is off by half a quantum; lifting and prediction add those of a few coefficients a level, twice
    const double quantum = 0.5 / 32767;
    const double tolerance = condition * (16 * view.levels * quantum + 60 * 0x1p-24);
    CHECK(relative_error(body.force(), 3, force) <= tolerance);
    Eigen::VectorXd displacement = Eigen::VectorXd::Zero(Eigen::Index{3} * view.node_count);
    for (std::uint32_t node = 0; node < view.node_count; ++node) {
      for (Eigen::Index j = 0; in_domain(view, node) && j < n; ++j) {
        displacement.segment<3>(Eigen::Index{3} * node) += compliance(node, contacts[j].node) * force.segment<3>(3 * j);
      }
    }
    CHECK(relative_error(body.field(), 4, displacement) <= tolerance);
  }
}

TEST_CASE("held nodes stand exactly where they are held") {
  const TestModel model({.levels = 4});
  TestBody body(model, {.max_contacts = 12, .cached_factors = 2});
  std::mt19937_64 random(15);
  for (int trial = 0; trial < 10; ++trial) {
    const auto contacts = random_contacts(random, model.touchable(), 12);
    REQUIRE(body.step(contacts, any_budget).status == Status::ok);
    for (const Constraint& contact : contacts) {
      for (std::size_t r = 0; r < 3; ++r) {
        CHECK(body.field()[std::size_t{4} * contact.node + r] == contact.value[r]);
      }
    }
  }
}

TEST_CASE("no step leaves anything behind for the next but factors and what it glides from") {
  const TestModel model({.levels = 4});
  const Elastostatic::Limits limits{.max_contacts = 12, .cached_factors = 2, .glide_cycles = 1};
  TestBody used(model, limits);
  std::mt19937_64 random(16);
  int compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    auto contacts = random_contacts(random, model.touchable(), 1 + random() % 12);
    const std::uint64_t least = used.requirement().least_work;
    const std::uint64_t budget = trial % 3 == 0 ? any_budget : least + random() % (8 * least);
    if (trial % 7 == 6) {
      contacts[0].value[0] = trial % 2 == 0 ? std::numeric_limits<float>::max() : 1e-30F;
    }
    TestBody fresh(model, limits);
    const Elastostatic::StepReport a = used.step(contacts, budget, trial % 5 != 4);
    const Elastostatic::StepReport b = fresh.step(contacts, budget, trial % 5 != 4);
    REQUIRE(a.status == b.status);
    REQUIRE(a.constraint_level == b.constraint_level);
    if (a.details.cached_factor || a.details.changed_nodes > 0) {
      continue;  // by chance the set's representatives, or most of them, were seen before
    }
    ++compared;
    if (answered(a.status)) {
      CHECK(std::equal(used.force().begin(), used.force().end(), fresh.force().begin()));
      if (trial % 5 != 4) {
        CHECK(std::equal(used.field().begin(), used.field().end(), fresh.field().begin()));
      }
    }
  }
  CHECK(compared > 50);
}

TEST_CASE("budgets: the level is the finest that fits, never a unit over, and finer with more") {
  ModelData data = synthetic_model({.levels = 4});
  for (std::size_t q = 0; q < 4; ++q) {
    data.levels[q].counts.field_error = 0.25F / static_cast<float>(q + 1);
    data.levels[q].counts.cut_error = 2.0F / static_cast<float>(q + 1);
    data.levels[q].counts.force_error = q == 3 ? 0.125F : 0.25F;
  }
  const TestModel model(encode(data));
  for (const bool with_field : {true, false}) {
    TestBody body(model, {.max_contacts = 12, .cached_factors = 2});
    const Elastostatic::Requirement& need = body.requirement();
    std::mt19937_64 random(6);
    const auto contacts = random_contacts(random, model.touchable(), 12);
    std::uint32_t rank = 0;
    std::uint32_t seen = 0;
    const std::uint64_t stride = (need.worst_work[3] - need.least_work) / 400;
    for (std::uint64_t budget = need.least_work; budget <= need.worst_work[3] + stride; budget += stride) {
      // a body of its own: no factor is cached
      TestBody fresh(model, {.max_contacts = 12, .cached_factors = 2});
      const Elastostatic::StepReport report = fresh.step(contacts, budget, with_field);
      REQUIRE(answered(report.status));
      CHECK(report.work <= budget);
      CHECK(report.work <= need.worst_work[report.constraint_level]);
      CHECK((report.status == Status::ok) == (report.constraint_level == 3 && report.field_level == 3));
      const layout::Level& at = *model.view().level[report.constraint_level].counts;
      const layout::Level& cut = *model.view().level[report.field_level].counts;
      const float field = report.field_level == 3 ? at.field_error : cut.cut_error;
      CHECK(report.error == std::max(at.force_error, with_field ? field : 0));
      const std::uint32_t now = 4 * report.constraint_level + report.field_level;
      CHECK(now >= rank);
      rank = now;
      seen |= 1U << report.constraint_level;
    }
    CHECK(rank == 15);
    CHECK(seen == 0xf);
    // one unit less than a level is planned to cost is a coarser level; what it costs is no more
    const Elastostatic::Limits limits{.max_contacts = 12};
    const std::uint64_t least = least_budget_of_finest(model, limits, contacts, with_field);
    CHECK(TestBody(model, limits).step(contacts, least, with_field).work <= least);
    CHECK(TestBody(model, limits).step(contacts, least, with_field).constraint_level == 3);
    CHECK(TestBody(model, limits).step(contacts, least - 1, with_field).constraint_level == 2);
  }
}

TEST_CASE("a finer level takes part of the budget only while its factor is made") {
  const TestModel model({.levels = 4});
  TestBody body(model, {.max_contacts = 12, .cached_factors = 2});
  std::mt19937_64 random(6);
  const auto contacts = random_contacts(random, model.touchable(), 12);
  const std::uint64_t whole = TestBody(model, {.max_contacts = 12}).step(contacts, any_budget).work;
  const std::uint64_t budget = whole / 4;
  Elastostatic::StepReport report = body.step(contacts, budget);
  CHECK(report.details.pending_work > 0);
  for (int step = 0; step < 20 && report.status != Status::ok; ++step) {
    report = body.step(contacts, budget);
  }
  REQUIRE(report.status != Status::coarser);
  CHECK(report.details.pending_work == 0);
  const std::uint64_t held = body.step(contacts, budget).work;
  TestBody cached(model, {.max_contacts = 12, .cached_factors = 2});
  cached.step(contacts, any_budget);
  CHECK(held == cached.step(contacts, any_budget).work);
  CHECK(body.step(contacts, budget).work == held);
}

TEST_CASE("a factor is reused bit for bit, in any order of the contacts") {
  const TestModel model({.levels = 4});
  TestBody body(model, {.max_contacts = 10, .cached_factors = 3});
  std::mt19937_64 random(9);
  auto contacts = random_contacts(random, model.touchable(), 10);
  const Elastostatic::StepReport fresh = body.step(contacts, any_budget);
  CHECK_FALSE(fresh.details.cached_factor);
  const std::vector<float> field(body.field().begin(), body.field().end());
  std::reverse(contacts.begin(), contacts.end());
  const Elastostatic::StepReport cached = body.step(contacts, any_budget);
  CHECK(cached.details.cached_factor);
  CHECK(cached.work < fresh.work);
  CHECK(std::equal(field.begin(), field.end(), body.field().begin()));
  // an unrelated set comes between
  body.step(random_contacts(random, model.touchable(), 3), any_budget);
  CHECK(body.step(contacts, any_budget).details.cached_factor);
}

TEST_CASE("in a glide the worse of both answers is reported, and infinity where nothing was measured") {
  ModelData data = synthetic_model({.levels = 4});
  for (std::uint32_t q = 0; q < 4; ++q) {
    auto& counts = data.levels[q].counts;
    counts.field_error = counts.force_error = counts.cut_error = 1.0F / static_cast<float>(1U << q);
  }
  const TestModel model(encode(data));
  TestBody body(model, {.max_contacts = 12, .cached_factors = 4, .glide_cycles = 4});
  std::mt19937_64 random(8);
  const auto contacts = random_contacts(random, model.touchable(), 12);
  CHECK(body.step(contacts, body.requirement().least_work).error > 0.125F);
  const float before = body.step(contacts, body.requirement().least_work, false).error;
  CHECK(before > 0.125F);
  for (int cycle = 1; cycle < 4; ++cycle) {
    const auto report = body.step(contacts, any_budget);
    REQUIRE(report.details.glide < 1);
    CHECK(report.error == before);
  }
  CHECK(body.step(contacts, any_budget).error == 0.125F);
  for (LevelData& level : data.levels) {
    level.counts.field_error = level.counts.force_error = level.counts.cut_error = 0;
  }
  const TestModel unmeasured(encode(data));
  TestBody other(unmeasured, {.max_contacts = 12, .cached_factors = 4});
  CHECK(other.step(contacts, any_budget).error == std::numeric_limits<float>::infinity());
  CHECK(other.step({}, any_budget).error == 0);
}

TEST_CASE("released: no contact, no field") {
  const TestModel model({.levels = 3});
  TestBody body(model, {.max_contacts = 4, .cached_factors = 1});
  std::mt19937_64 random(10);
  body.step(random_contacts(random, model.touchable(), 4), any_budget);
  const Elastostatic::StepReport report = body.step({}, body.requirement().least_work);
  CHECK(report.status == Status::ok);
  CHECK(std::all_of(body.field().begin(), body.field().end(), [](float u) { return u == 0; }));
  CHECK(body.step({}, body.requirement().least_work, false).work == priced(1, Prices{}.step));
}

// a body that has answered once, and what it must still show after a refusal
struct Held {
  explicit Held(const TestModel& model) : body(model, {.max_contacts = 4, .cached_factors = 2}) {
    std::mt19937_64 random(11);
    contacts = random_contacts(random, model.touchable(), 4);
    CHECK(body.step(contacts, any_budget).status == Status::ok);
    force.assign(body.force().begin(), body.force().end());
    field.assign(body.field().begin(), body.field().end());
  }
  // refused with `status`, nothing written, and the next good step is answered as before
  void refuses(std::span<const Constraint> bad, Status status, std::uint32_t refused, std::uint64_t work = any_budget) {
    const Elastostatic::StepReport report = body.step(bad, work);
    CHECK(report.status == status);
    CHECK(report.refused == refused);
    CHECK(report.work <= body.requirement().worst_work[2]);
    CHECK(std::equal(field.begin(), field.end(), body.field().begin()));
    if (bad.size() == contacts.size()) {
      CHECK(std::equal(force.begin(), force.end(), body.force().begin()));
    }
    const Elastostatic::StepReport good = body.step(contacts, any_budget);
    CHECK(good.status == Status::ok);
    CHECK(good.refused == StepReport::no_constraint);
    CHECK(std::equal(field.begin(), field.end(), body.field().begin()));
  }
  TestBody body;
  std::vector<Constraint> contacts;
  std::vector<float> force, field;
};

TEST_CASE("refusals have a name, write nothing and leave the body usable") {
  const TestModel model({.levels = 3});
  Held held(model);
  auto bad = held.contacts;
  bad[3].value[1] = std::numeric_limits<float>::quiet_NaN();
  held.refuses(bad, Status::held_not_finite, 3);
  bad = held.contacts;
  bad[3].node = model.view().node_count;
  held.refuses(bad, Status::held_out_of_range, 3);
  bad = held.contacts;
  bad[0].node = bad[3].node;
  held.refuses(bad, Status::held_duplicate, 3);
  for (const auto kind : {Constraint::Kind::normal, Constraint::Kind::force, Constraint::Kind::pattern}) {
    bad = held.contacts;
    bad[2] = {.node = layout::none, .kind = kind};  // what `node` is follows from the kind
    held.refuses(bad, Status::held_unsupported, 2);
  }
  bad = held.contacts;
  bad[2].node = model.view().node_count - 1;
  held.refuses(bad, Status::held_not_touchable, 2);
  bad = held.contacts;
  bad[1].value[2] = std::numeric_limits<float>::max();
  held.refuses(bad, Status::held_overflow, StepReport::no_constraint);
  held.refuses(held.contacts, Status::held_over_budget, StepReport::no_constraint,
               held.body.requirement().least_work - 1);
  held.refuses(held.contacts, Status::held_over_budget, StepReport::no_constraint, 0);
  bad = held.contacts;
  const auto nodes = model.touchable();
  bad.push_back({*std::find_if(nodes.begin(), nodes.end(),
                               [&](std::uint32_t node) {
                                 return std::none_of(bad.begin(), bad.end(),
                                                     [node](const Constraint& c) { return c.node == node; });
                               }),
                 {}});
  held.refuses(bad, Status::held_out_of_range, StepReport::no_constraint);  // more than the limits allow
}

TEST_CASE("the nodes of coarser levels, asked for alone, stand where the whole field has them, for less work") {
  for (const layout::Wavelet wavelet : layout::wavelets) {
    const TestModel model({.levels = 4, .wavelet = wavelet, .touchable_above = 0.3});
    const Elastostatic::Limits limits{.max_contacts = 12, .cached_factors = 2};
    TestBody whole(model, limits);
    TestBody part(model, limits);
    std::mt19937_64 random(17);
    for (std::uint32_t level = 0; level < model.view().levels; ++level) {
      const auto contacts = random_contacts(random, model.touchable(), 12);
      std::vector<float> force(3 * contacts.size());
      AlignedBytes memory(std::size_t{16} * model.model().node_count(level));
      const std::span<float> few(reinterpret_cast<float*>(memory.data()), memory.size() / sizeof(float));
      const Elastostatic::StepReport all = whole.step(contacts, any_budget);
      const Elastostatic::StepReport report = part.body().step(contacts, {any_budget}, {as_vec3(force), as_vec4(few)});
      CHECK(report.status == Status::ok);
      CHECK(report.field_level == level);
      CHECK((level + 1 == model.view().levels ? report.work == all.work : report.work < all.work));
      CHECK(std::equal(force.begin(), force.end(), whole.force().begin()));
      // without lifting a coarse node's displacement has no part in finer details
      CHECK((layout::is_lifted(wavelet) || std::equal(few.begin(), few.end(), whole.field().begin())));
    }
  }
}

TEST_CASE("a body for forces alone gives the same forces out of less memory, and refuses fields") {
  const TestModel model({.levels = 4, .touchable_above = 0.3});
  TestBody whole(model, {.max_contacts = 8, .cached_factors = 2});
  TestBody forces(model, {.max_contacts = 8, .cached_factors = 2, .forces_only = true});
  CHECK(3 * forces.requirement().bytes < 2 * whole.requirement().bytes);
  std::mt19937_64 random(18);
  for (int trial = 0; trial < 20; ++trial) {
    const auto contacts = random_contacts(random, model.touchable(), 8);
    CHECK(forces.step(contacts, any_budget, false).work == whole.step(contacts, any_budget, false).work);
    CHECK(std::equal(forces.force().begin(), forces.force().end(), whole.force().begin()));
    CHECK(answered(forces.step(contacts, forces.requirement().least_work, false).status));
    CHECK(forces.step(contacts, any_budget).status == Status::held_response_size);
  }
}

TEST_CASE("response buffers of the wrong size or alignment are refused") {
  const TestModel model({.levels = 2});
  TestBody body(model, {.max_contacts = 2, .cached_factors = 1});
  const std::vector<Constraint> contacts = {{model.touchable()[0], {1e-3F, 0, 0}}};
  std::vector<Vec3> more(2, Vec3{42, 42, 42});
  const auto force = std::span(more).first(1);
  const auto field = as_vec4(body.field());
  const auto status = [&](std::span<Vec3> forces, std::span<Vec4> displacement) {
    return body.body().step(contacts, {any_budget}, {forces, displacement}).status;
  };
  CHECK(status(more, field) == Status::held_response_size);
  CHECK(status({}, field) == Status::held_response_size);
  CHECK(status(force, field.first(field.size() - 1)) == Status::held_response_size);
  AlignedBytes crooked(field.size_bytes() + 64);
  CHECK(status(force, {reinterpret_cast<Vec4*>(crooked.data() + 4), field.size()}) == Status::held_response_size);
  CHECK(std::all_of(force.begin(), force.end(), [](const Vec3& f) { return f.x == 42 && f.y == 42 && f.z == 42; }));
  CHECK(status(force, {}) == Status::ok);
  CHECK(status(force, field) == Status::ok);
}

TEST_CASE("a capacitance matrix that is not positive definite is refused, not answered with garbage") {
  const TestModel model(encode(indefinite_model({.levels = 1})));
  TestBody body(model, {.max_contacts = 4, .cached_factors = 2});
  const auto nodes = model.touchable();
  REQUIRE(nodes.size() >= 2);
  const std::vector<Constraint> bad = {{nodes[0], {1e-3F, 0, 0}}, {nodes[1], {0, 1e-3F, 0}}};
  CHECK(body.step(bad, any_budget).status == Status::held_singular);
  CHECK(body.step(std::span(bad).first(1), any_budget).status == Status::ok);
  CHECK(body.step(bad, any_budget).status == Status::held_singular);
}

TEST_CASE("create: what is short or wrong is said in numbers") {
  const TestModel model({.levels = 2});
  const Elastostatic::Limits limits{.max_contacts = 5, .cached_factors = 2};
  const Elastostatic::Requirement need = Elastostatic::required(model.model(), limits);
  CHECK(need.alignment == 64);
  AlignedBytes memory(need.bytes + 64);
  const auto create = [&](const Elastostatic::Limits& l, std::size_t offset, std::size_t size) {
    return Elastostatic::create(model.model(), l, {memory.data() + offset, size});
  };
  CHECK(create(limits, 0, need.bytes));
  const auto small = create(limits, 0, need.bytes - 10);
  CHECK(small.error == CreateError::arena_too_small);
  CHECK(small.requested == need.bytes);
  CHECK(small.available == need.bytes - 10);
  CHECK(small.missing == 10);
  CHECK(create(limits, 4, need.bytes).error == CreateError::arena_misaligned);
  for (const Elastostatic::Limits& bad :
       {Elastostatic::Limits{0, 1}, Elastostatic::Limits{4097, 1}, Elastostatic::Limits{1, 0},
        Elastostatic::Limits{1, 1025}, Elastostatic::Limits{.glide_cycles = 0},
        Elastostatic::Limits{.glide_cycles = 257}}) {
    CHECK(create(bad, 0, memory.size()).error == CreateError::bad_limits);
    CHECK(Elastostatic::required(model.model(), bad).bytes == 0);
  }
  CHECK(Elastostatic::required(model.model(), {.max_contacts = 4096, .cached_factors = 1024}).bytes > need.bytes);
}

TEST_CASE("create refuses a refinement whose points hang on more than three coarse nodes") {
  ModelData data = synthetic_model({.levels = 4});
  // a touchable midpoint of the finest level between two midpoints of edges that share no triangle
  auto& refinement = data.levels[3].refinement;
  const auto& coarser = data.levels[2].refinement;
  const auto begin = static_cast<std::uint32_t>(data.levels[0].nodes.size() + data.levels[1].nodes.size());
  std::uint32_t other = 1;
  const auto shares = [&](std::uint32_t i) {
    return coarser[0].parent[0] == coarser[i].parent[0] || coarser[0].parent[0] == coarser[i].parent[1] ||
           coarser[0].parent[1] == coarser[i].parent[0] || coarser[0].parent[1] == coarser[i].parent[1];
  };
  const auto in_domain_with_parents = [&](std::uint32_t i) {
    return (data.levels[2].nodes[i].flags & layout::node_domain) != 0;
  };
  while (shares(other) || !in_domain_with_parents(other)) {
    ++other;
  }
  refinement[0].parent[0] = begin;
  refinement[0].parent[1] = begin + other;
  const TestModel model(encode(data));
  AlignedBytes memory(1 << 20);
  const auto created = Elastostatic::create(model.model(), {}, {memory.data(), memory.size()});
  CHECK(created.error == CreateError::unsupported_model);
  CHECK(Elastostatic::required(model.model(), {}).bytes == 0);
}

TEST_CASE("a scalar model is not supported") {
  const TestModel model({.components = 1, .levels = 2});
  AlignedBytes memory(1 << 20);
  const auto created = Elastostatic::create(model.model(), {}, {memory.data(), memory.size()});
  CHECK(created.error == CreateError::unsupported_model);
  CHECK(Elastostatic::required(model.model(), {}).bytes == 0);
}

}  // namespace
}  // namespace greenloop
