#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "runtime/greenloop.h"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr greenloop_elastostatic_limits limits{.max_contacts = 9,
                                               .cached_factors = 2,
                                               .forces_only = 0,
                                               .keep_capacitance = 0,
                                               .glide_cycles = 5,
                                               .refining_work = 0,
                                               .prices = nullptr,
                                               .max_forces = 0,
                                               .model_loads = 0,
                                               .max_points = 0};

// a body made and stepped through C alone
class CBody {
 public:
  CBody() : bytes_(encode(synthetic_model({.levels = 3, .touchable_above = 0.1}))) {
    REQUIRE(greenloop_open(bytes_.data(), bytes_.size(), &model).rule == GREENLOOP_RULE_OK);
    need = greenloop_elastostatic_required(&model, limits);
    arena_ = AlignedBytes(need.bytes);
    field_ = AlignedBytes(std::size_t{16} * greenloop_node_count(&model));
    created = greenloop_elastostatic_create(&model, limits, arena_.data(), arena_.size());
    REQUIRE(created.error == GREENLOOP_CREATE_OK);
  }

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_.span(); }
  [[nodiscard]] float* field() { return reinterpret_cast<float*>(field_.data()); }

  greenloop_model model{};
  greenloop_elastostatic_requirement need{};
  greenloop_elastostatic_created created{};

 private:
  AlignedBytes bytes_;
  AlignedBytes arena_;
  AlignedBytes field_;
};

std::vector<greenloop_constraint> random_contacts(std::mt19937_64& random,
                                                  const std::vector<std::uint32_t>& touchable) {
  std::vector<greenloop_constraint> contacts(random() % 11);
  const std::size_t first = random() % touchable.size();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto depth = static_cast<float>(random() % 1000) * 1e-6F;
    contacts[i] = {touchable[(first + i) % touchable.size()], {depth, 0, -depth}, GREENLOOP_HOLD};
  }
  if (!contacts.empty() && random() % 8 == 0) {
    contacts[0].value[1] = std::numeric_limits<float>::quiet_NaN();
  }
  return contacts;
}

std::vector<Constraint> to_cpp(const std::vector<greenloop_constraint>& contacts) {
  std::vector<Constraint> same;
  for (const auto& [node, u, kind] : contacts) {
    same.push_back({node, {u[0], u[1], u[2]}, static_cast<Constraint::Kind>(kind)});
  }
  return same;
}

TEST_CASE("C and C++ give the same answers, bit for bit") {
  CBody c;
  const TestModel model(c.bytes());
  TestBody body(model,
                {.max_contacts = limits.max_contacts, .cached_factors = limits.cached_factors, .glide_cycles = 5});
  CHECK(c.need.bytes == body.requirement().bytes);
  CHECK(c.need.least_work == body.requirement().least_work);
  CHECK(std::memcmp(c.need.worst_work, body.requirement().worst_work, sizeof c.need.worst_work) == 0);
  CHECK(greenloop_level_count(&c.model) == 3);
  const std::uint32_t nodes = greenloop_node_count_to(&c.model, 2);
  CHECK(nodes == greenloop_node_count(&c.model));
  CHECK(greenloop_node_count_to(&c.model, 3) == 0);
  std::mt19937_64 random(31);
  std::set<int> met;
  bool glided = false;
  for (int i = 0; i < 500; ++i) {
    const auto contacts = random_contacts(random, model.touchable());
    const std::uint64_t work = c.need.least_work - 1 + random() % c.need.worst_work[2];
    const bool with_field = i % 3 != 0;
    std::vector<float> force(3 * contacts.size());
    const auto report =
        greenloop_elastostatic_step(c.created.body, contacts.data(), contacts.size(), work, force.data(),
                                    with_field ? c.field() : nullptr, with_field ? nodes : 0);
    const Elastostatic::StepReport expected = body.step(to_cpp(contacts), work, with_field);
    REQUIRE(static_cast<int>(report.status) == static_cast<int>(expected.status));
    CHECK(report.refused == expected.refused);
    CHECK(report.constraint_level == expected.constraint_level);
    CHECK(report.details.held_contacts == expected.details.held_contacts);
    CHECK(report.details.waiting_contacts == expected.details.waiting_contacts);
    CHECK(report.field_level == expected.field_level);
    CHECK(report.error == expected.error);
    CHECK(report.work == expected.work);
    CHECK((report.details.cached_factor == 1) == expected.details.cached_factor);
    CHECK(report.details.changed_nodes == expected.details.changed_nodes);
    CHECK(report.details.glide == expected.details.glide);
    CHECK(report.details.level_difference == expected.details.level_difference);
    CHECK(report.details.switch_work == expected.details.switch_work);
    CHECK(report.details.needed_work == expected.details.needed_work);
    CHECK(report.details.pending_work == expected.details.pending_work);
    glided |= report.details.glide < 1;
    met.insert(report.status);
    if (report.status <= GREENLOOP_COARSER) {
      CHECK((force.empty() || std::memcmp(force.data(), body.force().data(), sizeof(float) * force.size()) == 0));
      CHECK(std::memcmp(c.field(), body.field().data(), body.field().size_bytes()) == 0);
    }
  }
  CHECK(glided);
  CHECK(met.count(GREENLOOP_OK) == 1);
  CHECK(met.count(GREENLOOP_COARSER) == 1);
  CHECK(met.count(GREENLOOP_HELD_NOT_FINITE) == 1);
  CHECK(met.count(GREENLOOP_HELD_OUT_OF_RANGE) == 1);
}

TEST_CASE("nodes are described, those that are not there are refused") {
  CBody c;
  const TestModel model(c.bytes());
  std::size_t touchable = 0;
  float position[3] = {};
  for (std::uint32_t node = 0; node < greenloop_node_count(&c.model); ++node) {
    touchable += greenloop_is_touchable(&c.model, node) != 0 ? 1 : 0;
    REQUIRE(greenloop_position(&c.model, node, position) == 1);
    CHECK(position[0] * position[0] + position[1] * position[1] + position[2] * position[2] ==
          doctest::Approx(0.01).epsilon(1e-5));
  }
  CHECK(touchable == model.touchable().size());
  CHECK(touchable < greenloop_node_count(&c.model));
  CHECK(greenloop_is_touchable(&c.model, greenloop_node_count(&c.model)) == 0);
  CHECK(greenloop_position(&c.model, greenloop_node_count(&c.model), position) == 0);
}

TEST_CASE("what is wrong is named") {
  CBody c;
  std::vector<std::byte> damaged(c.bytes().begin(), c.bytes().end());
  damaged[damaged.size() / 2] ^= std::byte{1};
  const AlignedBytes file(damaged);
  greenloop_model model;
  const greenloop_fault fault = greenloop_open(file.data(), file.size(), &model);
  CHECK(fault.rule == GREENLOOP_RULE_SECTION_CHECKSUM);
  CHECK(fault.section != 0);
  CHECK(std::string(fault.field) == "section.crc");
  CHECK(greenloop_open(file.data(), 10, &model).rule == GREENLOOP_RULE_TOO_SHORT);

  AlignedBytes arena(c.need.bytes);
  const auto small = greenloop_elastostatic_create(&c.model, limits, arena.data(), c.need.bytes - 64);
  CHECK(small.error == GREENLOOP_CREATE_ARENA_TOO_SMALL);
  CHECK(small.requested == c.need.bytes);
  CHECK(small.missing == 64);
  CHECK(small.body == nullptr);
  CHECK(greenloop_elastostatic_create(&c.model, {0, 1, 0, 0, 1, 0, nullptr, 0, 0, 0, 0, 0}, arena.data(), c.need.bytes)
            .error == GREENLOOP_CREATE_BAD_LIMITS);
}

TEST_CASE("the loop that a model is meant for is the scene's, and a body keeps to it") {
  CBody body;
  const greenloop_elastostatic_intent intent = greenloop_elastostatic_intended(&body.model);
  const auto opened = Model::open(body.bytes());
  const Elastostatic::Intent same = Elastostatic::intended(opened.model);
  CHECK(intent.limits.max_contacts == opened.model.view().info->max_contacts);
  CHECK(intent.limits.max_contacts == same.limits.max_contacts);
  CHECK(intent.limits.cached_factors == same.limits.cached_factors);
  CHECK(intent.limits.forces_only == 0);
  CHECK(intent.limits.glide_cycles == same.limits.glide_cycles);
  CHECK(intent.limits.refining_work == same.limits.refining_work);
  CHECK(intent.work == opened.model.view().info->step_work);
  CHECK(intent.work == same.budget.work);
  CHECK(intent.rate == opened.model.view().info->rate);
  CHECK(intent.share == 1);
  CHECK(intent.share == same.share);
  CHECK(greenloop_elastostatic_required(&body.model, intent.limits).least_work <= intent.work);
}

TEST_CASE("a share of the period that the scene states is told") {
  ModelData data = synthetic_model({.levels = 2});
  data.info.share = 0.4F;
  const AlignedBytes bytes(encode(data));
  greenloop_model model{};
  REQUIRE(greenloop_open(bytes.data(), bytes.size(), &model).rule == GREENLOOP_RULE_OK);
  CHECK(greenloop_elastostatic_intended(&model).share == 0.4F);
  CHECK(Elastostatic::intended(Model::open(bytes.span()).model).share == 0.4F);
}

TEST_CASE("no cycles of a glide stand for the default") {
  CBody c;
  const auto bytes = [&c](std::uint32_t cycles) {
    return greenloop_elastostatic_required(&c.model, {9, 2, 0, 0, cycles, 0, nullptr, 0, 0, 0}).bytes;
  };
  CHECK(bytes(0) == bytes(Elastostatic::Limits{}.glide_cycles));
  CHECK(bytes(256) > 0);
  CHECK(bytes(257) == 0);
}

TEST_CASE("no refining work stands for no bound of it") {
  CBody c;
  const auto worst = [&c](std::uint64_t work) {
    return greenloop_elastostatic_required(&c.model, {9, 2, 0, 0, 0, work, nullptr, 0, 0, 0, 0, 0}).worst_work[0];
  };
  CHECK(worst(0) == worst(~std::uint64_t{0}));
  CHECK(worst(1) < worst(0));
}

TEST_CASE("no prices stand for the default ones, and others make other work") {
  const CBody body;
  greenloop_prices prices = greenloop_default_prices();
  CHECK(prices.slot == Prices{}.slot);
  CHECK(greenloop_cortex_m7_prices().slot == cortex_m7_prices().slot);
  greenloop_elastostatic_limits priced = limits;
  priced.prices = &prices;
  CHECK(greenloop_elastostatic_required(&body.model, priced).least_work == body.need.least_work);
  prices.step += 256;
  CHECK(greenloop_elastostatic_required(&body.model, priced).least_work == body.need.least_work + 1);
}

TEST_CASE("a scalar model opens, says its problem and gets no elastostatic body; an elastostatic one says its own") {
  const AlignedBytes scalar(encode(synthetic_model({.components = 1, .levels = 2})));
  const AlignedBytes elastostatic(encode(synthetic_model({.levels = 2})));
  greenloop_model model;
  REQUIRE(greenloop_open(scalar.data(), scalar.size(), &model).rule == GREENLOOP_RULE_OK);
  CHECK(greenloop_model_problem(&model) == GREENLOOP_PROBLEM_SCALAR);
  CHECK(greenloop_node_count(&model) == 18);
  AlignedBytes arena(1 << 20);
  CHECK(greenloop_elastostatic_required(&model, limits).bytes == 0);
  CHECK(greenloop_elastostatic_create(&model, limits, arena.data(), arena.size()).error ==
        GREENLOOP_CREATE_UNSUPPORTED_MODEL);
  REQUIRE(greenloop_open(elastostatic.data(), elastostatic.size(), &model).rule == GREENLOOP_RULE_OK);
  CHECK(greenloop_model_problem(&model) == GREENLOOP_PROBLEM_ELASTOSTATIC);
}

TEST_CASE("every code has a text of its own") {
  std::set<std::string> texts;
  for (int rule = GREENLOOP_RULE_OK; rule <= GREENLOOP_RULE_INCONSISTENT; ++rule) {
    texts.insert(greenloop_rule_text(static_cast<greenloop_rule>(rule)));
  }
  for (int error = GREENLOOP_CREATE_OK; error <= GREENLOOP_CREATE_MISMATCHED_MODELS; ++error) {
    texts.insert(greenloop_create_error_text(static_cast<greenloop_create_error>(error)));
  }
  for (int status = GREENLOOP_OK; status <= GREENLOOP_HELD_ILLEGAL_IMPULSE; ++status) {
    texts.insert(greenloop_status_text(static_cast<greenloop_status>(status)));
  }
  CHECK(texts.size() == (GREENLOOP_RULE_INCONSISTENT + 1) + (GREENLOOP_CREATE_MISMATCHED_MODELS + 1) +
                            (GREENLOOP_HELD_ILLEGAL_IMPULSE + 1));
  CHECK(std::string(greenloop_rule_text(static_cast<greenloop_rule>(GREENLOOP_RULE_INCONSISTENT + 1))) == "unknown");
  greenloop_model none;
  CHECK(greenloop_open(nullptr, 0, &none).rule != GREENLOOP_RULE_OK);
  CHECK(greenloop_model_problem(&none) == 0);
  CHECK(greenloop_is_touchable(&none, 0) == 0);
  CHECK(texts.count("unknown") == 0);
  CHECK(std::string(greenloop_status_text(static_cast<greenloop_status>(15))) == "unknown");
}

}  // namespace
}  // namespace greenloop
