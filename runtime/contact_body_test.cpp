#include "runtime/contact_body.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/algebra/fnv1a.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// a contact body in memory of its own
class TouchableBody {
 public:
  explicit TouchableBody(const TestModel& model, const ContactBody::Limits& limits = usual())
      : requirement_(ContactBody::required(model.model(), limits)), memory_(requirement_.bytes) {
    const auto created = ContactBody::create(model.model(), limits, {memory_.data(), memory_.size()});
    REQUIRE(created);
    body = created.body;
  }
  static ContactBody::Limits usual() {
    ContactBody::Limits limits;
    limits.elastostatic = {.max_contacts = 64, .cached_factors = 4, .iterations = 50};
    return limits;
  }
  ContactBody::StepReport step(const std::vector<ContactBody::ToolInput>& tools, std::uint64_t work = any_budget) {
    return body.step(tools, {}, {work});
  }
  [[nodiscard]] const ContactBody::Requirement& requirement() const { return requirement_; }

  ContactBody body;

 private:
  ContactBody::Requirement requirement_;
  AlignedBytes memory_;
};

constexpr SyntheticOptions sphere{.levels = 4};

// the synthetic body: a sphere around the origin, touchable where it is free
double radius_of(const TestModel& model) {
  const float* x = node_record(model.view(), model.touchable().front()).position;
  return std::sqrt(double{x[0]} * x[0] + double{x[1]} * x[1] + double{x[2]} * x[2]);
}

ContactBody::ToolInput ball(double radius, const Double3& centre, double friction) {
  return {{Shape::sphere(radius), {centre, {1, 0, 0, 0}}}, friction};
}

void check_laws(const ContactBody& body, std::span<const ContactBody::ToolInput> tools) {
  for (const ContactBody::Contact& contact : body.contacts()) {
    const double pressed = dot(contact.force, contact.normal);
    CHECK(pressed >= 0);
    const double along = norm(contact.force - pressed * contact.normal);
    CHECK(along <= (tools[contact.tool].friction + 1e-6) * pressed);
    if (contact.state == ContactState::open) CHECK(norm(contact.force) == 0);
  }
}

TEST_CASE("a ball that is pressed in is pushed out, by as much as its contacts are pushed in") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius;
  double last = 0;
  for (int k = 0; k <= 20; ++k) {
    const double depth = 0.002 * body_radius * (k - 5);
    const std::vector tools{ball(radius, {0, 0, body_radius + radius - depth}, 0.3)};
    const auto report = touched.step(tools);
    REQUIRE(answered(report.status));
    check_laws(touched.body, tools);
    const ContactBody::ToolAnswer& answer = touched.body.tools()[0];
    CHECK(answer.fault == ToolFault::none);
    Double3 sum;
    for (const ContactBody::Contact& contact : touched.body.contacts()) sum += contact.force;
    CHECK(norm(sum + answer.force) <= 1e-6 * norm(sum));
    if (depth < -0.001 * body_radius) CHECK(answer.force.z == 0);
    if (depth > 0) {
      CHECK(answer.force.z > last);
      CHECK(report.residual <= 1e-3);
    }
    last = answer.force.z;
  }
}

TEST_CASE("contacts stand for the surface around them: the areas of all nodes are that of the body") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model);
  double sum = 0;
  for (std::uint32_t node = 0; node < model.model().node_count(); ++node) {
    ContactBody::Contact contact;
    contact.node[0] = node;
    contact.node[1] = contact.node[2] = layout::none;
    contact.weight[0] = 1;
    sum += touched.body.area(contact);
  }
  constexpr double of_unit_sphere = 12.566370614359172;
  CHECK(sum == doctest::Approx(of_unit_sphere * body_radius * body_radius).epsilon(0.02));
}

TEST_CASE("friction holds a ball that is dragged, up to its coefficient") {
  const TestModel model(sphere);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius, depth = 0.03 * body_radius;
  for (const double friction : {0.0, 0.2, 0.6}) {
    TouchableBody touched(model);
    double ratio = 0, most = 0;
    for (int k = 0; k < 60; ++k) {
      const double along = k < 5 ? 0 : 0.001 * body_radius * (k - 5);
      const std::vector tools{ball(radius, {along, 0, body_radius + radius - depth}, friction)};
      REQUIRE(answered(touched.step(tools).status));
      check_laws(touched.body, tools);
      const Double3 force = touched.body.tools()[0].force;
      ratio = -force.x / force.z;
      most = std::max(most, ratio);
    }
    MESSAGE("friction ", friction, ": the drag ends at ", ratio, " of the pressure, at most ", most);
    if (friction == 0) CHECK(std::abs(ratio) < 0.1);  // the ball has come to where the surface slopes
    if (friction > 0) CHECK(most > 0.5 * friction);
    CHECK(most < friction + 0.1);
  }
}

TEST_CASE("contacts come and go without jumps of the force while a ball slides") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model), radius = 2 * body_radius, depth = 0.06 * body_radius;
  Double3 last;
  double most = 0;
  std::size_t changes = 0, contacts = 0;
  for (int k = 0; k < 400; ++k) {
    const double angle = 0.0008 * k;
    const double distance = body_radius + radius - depth;
    const std::vector tools{ball(radius, {distance * std::sin(angle), 0, distance * std::cos(angle)}, 0.3)};
    REQUIRE(answered(touched.step(tools).status));
    const Double3 force = touched.body.tools()[0].force;
    if (k > 20) most = std::max(most, norm(force - last) / norm(force));
    changes += k > 20 && touched.body.contacts().size() != contacts ? 1 : 0;
    contacts = touched.body.contacts().size();
    last = force;
  }
  MESSAGE("sliding: ", changes, " changes of the contacts, largest step of the force ", 100 * most, " %");
  CHECK(changes > 5);
  CHECK(most <= 0.02);
}

TEST_CASE("a tool with a bad pose is left out by name, and what it was stays") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius;
  std::vector tools{ball(radius, {0, 0, 1.27 * body_radius}, 0.3), ball(radius, {1.27 * body_radius, 0, 0}, 0.3)};
  REQUIRE(answered(touched.step(tools).status));
  const double alone = touched.body.tools()[1].force.x;
  CHECK(touched.body.tools()[0].force.z > 0);
  tools[0].tool.pose.position.y = std::numeric_limits<double>::quiet_NaN();
  REQUIRE(answered(touched.step(tools).status));
  CHECK(touched.body.tools()[0].fault == ToolFault::not_finite);
  CHECK(touched.body.tools()[0].force.z == 0);
  CHECK(touched.body.tools()[1].force.x == doctest::Approx(alone).epsilon(0.05));
  tools[0].tool.pose = {{0, 0, 1.27 * body_radius}, {1, 1, 0, 0}};
  REQUIRE(answered(touched.step(tools).status));
  CHECK(touched.body.tools()[0].fault == ToolFault::not_unit);
  tools.push_back(tools[1]);
  CHECK(touched.step(tools).status == Status::held_out_of_range);
}

TEST_CASE("whatever the budget, the answer obeys the laws and the budget; too small a one is refused") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius;
  const std::uint64_t enough = touched.requirement().least_work;
  const std::uint64_t touching = touched.body.touching_work(std::vector{ball(radius, {}, 0.3)});
  std::uint64_t least = 0;
  for (std::uint64_t budget = 1; budget < (std::uint64_t{1} << 40); budget += budget / 8 + 1) {
    const std::vector tools{ball(radius, {0, 0, 1.25 * body_radius}, 0.3)};
    const auto report = touched.step(tools, budget);
    if (report.status == Status::held_over_budget) {
      CHECK(budget < enough);
      CHECK(report.work == 0);
      CHECK(least == 0);
      continue;
    }
    least = least == 0 ? budget : least;
    REQUIRE(answered(report.status));
    CHECK(report.work <= budget);
    CHECK(report.touching_work > 0);
    CHECK(report.touching_work < report.work);
    CHECK(report.touching_work <= touching);
    CHECK(touching <= touched.requirement().touching_work);
    check_laws(touched.body, tools);
  }
  CHECK(least > 0);
  CHECK(least >= enough);
}

TEST_CASE("what a body cannot be made with is refused by name") {
  const TestModel model(sphere);
  const auto refused = [&](auto change) {
    ContactBody::Limits limits = TouchableBody::usual();
    change(limits);
    CHECK(ContactBody::required(model.model(), limits).bytes == 0);
    return ContactBody::create(model.model(), limits, {}).error;
  };
  using Limits = ContactBody::Limits;
  CHECK(refused([](Limits& of) { of.max_tools = 0; }) == CreateError::bad_limits);
  CHECK(refused([](Limits& of) { of.max_points = 129; }) == CreateError::bad_limits);
  CHECK(refused([](Limits& of) { of.margin = -1; }) == CreateError::bad_limits);
  CHECK(refused([](Limits& of) { of.elastostatic.iterations = 0; }) == CreateError::bad_limits);
  CHECK(refused([](Limits& of) { of.elastostatic.max_contacts = 257; }) == CreateError::bad_limits);
  CHECK(refused([](Limits& of) { of.search_work = 1000; }) == CreateError::bad_limits);
  const ContactBody::Created small = ContactBody::create(model.model(), TouchableBody::usual(), {});
  CHECK(small.error == CreateError::arena_too_small);
  CHECK(small.missing == small.requested);
}

// limits of one tool of one point, whose search has the least share that is taken
ContactBody::Limits starved(const TestModel& model) {
  ContactBody::Limits limits = TouchableBody::usual();
  limits.max_tools = 1;
  limits.max_points = 1;
  limits.search_work = 1000;
  while (ContactBody::required(model.model(), limits).bytes == 0) limits.search_work += 1000;
  return limits;
}

TEST_CASE("a search that is cut finds what is deepest") {
  const TestModel model({.levels = 5});
  const double body_radius = radius_of(model), radius = 0.5 * body_radius;
  const std::vector tools{ball(radius, {0, 0, 1.4 * body_radius}, 0.3)};
  TouchableBody whole(model);
  REQUIRE(answered(whole.step(tools).status));
  TouchableBody touched(model, starved(model));
  const auto report = touched.step(tools);
  REQUIRE(answered(report.status));
  CHECK(report.unfinished == 1);
  CHECK(report.touching_work <= touched.requirement().touching_work);
  check_laws(touched.body, tools);
  CHECK(touched.body.contacts().size() < whole.body.contacts().size());
  CHECK(touched.body.tools()[0].depth == whole.body.tools()[0].depth);
}

TEST_CASE("however little a search may take, a point that goes through the body is held where it came from") {
  const TestModel model({.levels = 5});
  const double body_radius = radius_of(model);
  for (const double step : {0.02, 0.3, 3.0}) {
    TouchableBody touched(model, starved(model));
    std::uint32_t left_out = 0, behind = 0;
    for (double z = 1.1; z > -2; z -= step) {
      const std::vector tools{ContactBody::ToolInput{{Shape(), {{1e-3, 2e-3, z * body_radius}, {1, 0, 0, 0}}}, 0.3}};
      const auto report = touched.step(tools);
      REQUIRE(answered(report.status));
      CHECK(report.touching_work <= touched.requirement().touching_work);
      const ContactBody::ToolAnswer& answer = touched.body.tools()[0];
      left_out += report.unfinished;
      behind += answer.is_behind ? 1 : 0;
      if (z < 0.95) CHECK((answer.is_behind || report.unfinished == 1));
      if (answer.is_behind && z > -1) CHECK(norm(answer.force) > 0);
    }
    MESSAGE("steps of ", step, " radii: held in ", behind, ", left out in ", left_out);
    if (step < 1) CHECK(behind > 5);
  }
}

TEST_CASE("a tool that is left out for a step holds on to what it held") {
  const TestModel model(sphere);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius, depth = 0.03 * body_radius;
  const std::vector still{ball(radius, {0, 0, body_radius + radius - depth}, 1)};
  const std::vector dragged{ball(radius, {0.01 * body_radius, 0, body_radius + radius - depth}, 1)};
  std::vector faulty = still;
  faulty[0].tool.pose.quaternion[0] = 2;
  double drag[3] = {};
  for (const int way : {0, 1, 2}) {  // straight on; left out for a step; not there for a step
    TouchableBody touched(model);
    for (int k = 0; k < 3; ++k) REQUIRE(answered(touched.step(still).status));
    if (way == 1) REQUIRE(answered(touched.step(faulty).status));
    if (way == 2) REQUIRE(answered(touched.step({}).status));
    if (way != 0) CHECK(touched.body.contacts().empty());
    REQUIRE(answered(touched.step(dragged).status));
    const Double3 force = touched.body.tools()[0].force;
    drag[way] = std::abs(force.x) / force.z;
    CHECK(std::abs(touched.body.energy().generated) < 1e-6);
  }
  MESSAGE("drag over pressure: straight on ", drag[0], ", left out ", drag[1], ", not there ", drag[2]);
  CHECK(drag[0] > 0.1);
  CHECK(drag[1] > 0.5 * drag[0]);
  CHECK(drag[2] > 0.5 * drag[0]);
}

TEST_CASE("energy adds up when a tool goes right after a step that was refused") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius;
  std::vector tools{ball(radius, {0, 0, 1.3 * body_radius}, 0.3)};
  for (int k = 0; k < 10; ++k) {
    tools[0].tool.pose.position.z = (1.3 - 0.004 * k) * body_radius;
    REQUIRE(answered(touched.step(tools).status));
  }
  CHECK(touched.body.energy().stored > 0);
  tools[0].friction = std::numeric_limits<double>::quiet_NaN();
  CHECK(touched.step(tools).status == Status::held_not_finite);
  tools[0].friction = 0.3;
  tools[0].tool.pose.position.z = 2 * body_radius;
  REQUIRE(answered(touched.step(tools).status));
  REQUIRE(touched.body.contacts().empty());
  const ContactBody::Energy& energy = touched.body.energy();
  CHECK(energy.stored == 0);
  CHECK(energy.in == doctest::Approx(energy.dissipated + energy.lost).epsilon(1e-3));
}

TEST_CASE("what does not add up of the energy is rounding, while tools press, drag, lift and slide") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius;
  double handled = 0, last = 0;
  for (int k = 0; k < 600; ++k) {
    const double angle = 0.4 * std::sin(0.02 * k), depth = 0.02 * body_radius * std::sin(0.05 * k);
    const double distance = body_radius + radius - depth;
    const std::vector tools{ball(radius, {distance * std::sin(angle), 0, distance * std::cos(angle)}, 0.3)};
    REQUIRE(answered(touched.step(tools).status));
    const ContactBody::Energy& energy = touched.body.energy();
    handled += std::abs(energy.in - last);
    last = energy.in;
  }
  const ContactBody::Energy& energy = touched.body.energy();
  MESSAGE("of ", handled, " J handled do not add up ", energy.stored + energy.dissipated + energy.lost - energy.in,
          " J, at most ", energy.generated);
  CHECK(energy.dissipated > 0.01 * handled);
  CHECK(energy.generated <= 1e-5 * handled);
  CHECK(std::abs(energy.stored + energy.dissipated + energy.lost - energy.in) <= 1e-5 * handled);
}

TEST_CASE("a tool on a spring sags as far as its force says, and feels body and spring in series") {
  const TestModel model(sphere);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius;
  const auto pressed = [&](double compliance, double depth, std::size_t steps) {
    TouchableBody touched(model);
    std::vector tools{ball(radius, {0.1 * depth, 0, body_radius + radius - depth}, 0.3)};
    tools[0].compliance = compliance;
    for (std::size_t k = 0; k < steps; ++k) REQUIRE(answered(touched.step(tools).status));
    check_laws(touched.body, tools);
    return touched.body.tools()[0];
  };
  const double depth = 0.02 * body_radius;
  const ContactBody::ToolAnswer rigid = pressed(0, depth, 3);
  CHECK(norm(rigid.sag) == 0);
  const double compliance = depth / rigid.force.z;
  const ContactBody::ToolAnswer soft = pressed(compliance, depth, 3);
  CHECK(norm(soft.sag - compliance * soft.force) <= 1e-9 * norm(soft.sag));
  CHECK(soft.force.z < 0.7 * rigid.force.z);
  // where the spring lets it be, a rigid tool feels the same
  const ContactBody::ToolAnswer there = pressed(0, depth - soft.sag.z, 3);
  CHECK(there.force.z == doctest::Approx(soft.force.z).epsilon(0.02));
  TouchableBody touched(model);
  std::vector tools{ball(radius, {0, 0, body_radius + radius - depth}, 0.3)};
  tools[0].compliance = -1e-3;
  CHECK(touched.step(tools).status == Status::held_bad_surface);
  tools[0].compliance = std::numeric_limits<double>::quiet_NaN();
  CHECK(touched.step(tools).status == Status::held_not_finite);
}

TEST_CASE("friction of a region is its factor times the tool's, zero too, and may change between steps") {
  const TestModel model(sphere);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius, depth = 0.03 * body_radius;
  TouchableBody touched(model);
  std::vector<float> factor(touched.body.displacement().size(), 1);
  touched.body.surface_friction(factor);
  std::vector tools{ball(radius, {0, 0, body_radius + radius - depth}, 0.6)};
  const auto most_ratio = [&] {
    double most = 0;
    for (int k = 0; k < 10; ++k) {
      tools[0].tool.pose.position.x += 0.001 * body_radius;
      REQUIRE(answered(touched.step(tools).status));
      for (const ContactBody::Contact& contact : touched.body.contacts()) {
        const double pressed = dot(contact.force, contact.normal);
        if (pressed > 0) most = std::max(most, norm(contact.force - pressed * contact.normal) / pressed);
      }
    }
    return most;
  };
  CHECK(most_ratio() == doctest::Approx(0.6).epsilon(0.05));
  std::fill(factor.begin(), factor.end(), 0.25F);
  CHECK(most_ratio() == doctest::Approx(0.15).epsilon(0.01));
  std::fill(factor.begin(), factor.end(), 0.0F);
  CHECK(most_ratio() <= 1e-6);
  std::fill(factor.begin(), factor.end(), -1.0F);
  CHECK(touched.step(tools).status == Status::held_bad_surface);
  touched.body.surface_friction({factor.data(), 3});  // too few: the old ones stay
  CHECK(touched.step(tools).status == Status::held_bad_surface);
  touched.body.surface_friction({});
  CHECK(answered(touched.step(tools).status));
}

TEST_CASE("between two steps a local model says what a step would") {
  const TestModel model(sphere);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius, depth = 0.03 * body_radius;
  for (const double compliance : {0.0, 1e-4}) {
    TouchableBody touched(model);
    LocalModel local;
    CHECK(touched.body.local_model(false, 1e-3F, local) == 0);
    std::vector tools{ball(radius, {0, 0, body_radius + radius - depth}, 0.3)};
    tools[0].compliance = compliance;
    for (int k = 0; k < 5; ++k) REQUIRE(answered(touched.step(tools).status));
    const std::uint64_t work = touched.body.local_model(true, static_cast<float>(radius), local);
    CHECK(work > 0);
    CHECK(work <= touched.body.local_model_work(1, true));
    const Double3 before = touched.body.tools()[0].force;
    REQUIRE(local.tools == 1);
    REQUIRE(local.components == 6);
    CHECK(local.wrench[2] == doctest::Approx(before.z).epsilon(1e-5));
    CHECK(local.change[2][2] < 0);
    REQUIRE(local.range > 0);
    const float step = std::min(0.5F * local.range, static_cast<float>(1e-3 * depth));
    const float motion[6] = {0, 0, -step, 0, 0, 0};
    float wrench[6];
    local.evaluate(motion, wrench);
    tools[0].tool.pose.position.z -= static_cast<double>(step);
    REQUIRE(answered(touched.step(tools).status));
    const Double3 after = touched.body.tools()[0].force;
    CHECK(static_cast<double>(wrench[2]) - before.z == doctest::Approx(after.z - before.z).epsilon(0.2));
    CHECK(touched.body.local_model(true, 0, local) == 0);
    REQUIRE(answered(touched.step({}).status));
    CHECK(touched.body.local_model(true, 1e-3F, local) == 0);
  }
}

TEST_CASE("a tool that is put elsewhere drags nothing along, one that moves there does") {
  const TestModel model(sphere);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius, depth = 0.03 * body_radius;
  double drag[2] = {};
  for (const bool forgotten : {false, true}) {
    TouchableBody touched(model);
    std::vector tools{ball(radius, {0, 0, body_radius + radius - depth}, 1)};
    for (int k = 0; k < 3; ++k) REQUIRE(answered(touched.step(tools).status));
    if (forgotten) touched.body.forget(0);
    tools[0].tool.pose.position.x = 0.01 * body_radius;
    REQUIRE(answered(touched.step(tools).status));
    const Double3 force = touched.body.tools()[0].force;
    drag[forgotten ? 1 : 0] = std::abs(force.x) / force.z;
  }
  MESSAGE("drag over pressure: moved ", drag[0], ", put there ", drag[1]);
  CHECK(drag[0] > 0.1);
  CHECK(drag[1] < 0.5 * drag[0]);
}

TEST_CASE("a place that cannot move pushes back too") {
  const TestModel model(sphere);
  TouchableBody touched(model);
  const double body_radius = radius_of(model), radius = 0.3 * body_radius;
  const std::vector tools{ball(radius, {0, 0, -1.25 * body_radius}, 0.3)};
  REQUIRE(answered(touched.step(tools).status));
  check_laws(touched.body, tools);
  CHECK(touched.body.tools()[0].force.z < 0);
}

TEST_CASE("the same tools give the same bits") {
  std::uint64_t digest[2] = {};
  for (std::uint64_t& value : digest) {
    const TestModel model(sphere);
    TouchableBody touched(model);
    const double body_radius = radius_of(model);
    Fnv1a all;
    for (int k = 0; k < 50; ++k) {
      const std::vector tools{
          ball(0.3 * body_radius, {0.01 * k * body_radius, 0, (1.4 - 0.004 * k) * body_radius}, 0.4)};
      const std::uint64_t budget = touched.requirement().worst_work + (std::uint64_t{1} << 26);
      REQUIRE(answered(touched.step(tools, budget).status));
      all.add(std::as_bytes(touched.body.displacement()));
      all.add(std::as_bytes(std::span(&touched.body.tools()[0].force, 1)));
    }
    value = all.value();
  }
  CHECK(digest[0] == digest[1]);
}

}  // namespace
}  // namespace greenloop
