#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/contact_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// a ball at the synthetic sphere, around the origin
class BallOnSphere {
 public:
  BallOnSphere(std::uint32_t max_contacts, double friction, std::uint32_t levels = 4)
      : model_(SyntheticOptions{.levels = levels}), friction_(friction) {
    ContactBody::Limits limits;
    limits.elastostatic = {.max_contacts = max_contacts, .cached_factors = 4, .iterations = 50};
    requirement_ = ContactBody::required(model_.model(), limits);
    memory_ = AlignedBytes(requirement_.bytes);
    const auto created = ContactBody::create(model_.model(), limits, {memory_.data(), memory_.size()});
    REQUIRE(created);
    body = created.body;
    const float* x = node_record(model_.view(), model_.touchable().front()).position;
    body_radius = std::sqrt(double{x[0]} * x[0] + double{x[1]} * x[1] + double{x[2]} * x[2]);
    // equilateral triangles
    edge = body_radius * std::sqrt(8 * std::acos(-1.0) / (std::sqrt(3.0) * (model_.view().node_count - 2)));
  }

  /// Force on a ball that is `depth` deep at a polar angle; work: units, or no limit.
  double press(double radius, double depth, double angle, std::uint64_t work = any_budget) {
    const double distance = body_radius + radius - depth;
    const Double3 centre{distance * std::sin(angle) * std::cos(0.3), distance * std::sin(angle) * std::sin(0.3),
                         distance * std::cos(angle)};
    const ContactBody::ToolInput tool{{Shape::sphere(radius), {centre, {1, 0, 0, 0}}}, friction_};
    report = body.step({&tool, 1}, {}, {work});
    REQUIRE(answered(report.status));
    for (const ContactBody::Contact& contact : body.contacts()) {
      const double pressed = dot(contact.force, contact.normal);
      CHECK(pressed >= 0);
      CHECK(norm(contact.force - pressed * contact.normal) <= (friction_ + 1e-6) * pressed);
    }
    return norm(body.tools()[0].force);
  }
  [[nodiscard]] const ContactBody::Requirement& requirement() const { return requirement_; }

  ContactBody body;
  ContactBody::StepReport report;
  double body_radius = 0, edge = 0;

 private:
  TestModel model_;
  double friction_;
  ContactBody::Requirement requirement_;
  AlignedBytes memory_;
};

TEST_CASE("with less room than a ball touches places, what is pushed stays, and so does the force") {
  BallOnSphere bench(5, 0.3);
  double last = 0;
  std::uint32_t left_out = 0;
  for (int k = 0; k < 80; ++k) {
    const double force = bench.press(0.5 * bench.body_radius, 0.002 * bench.body_radius * std::min(k, 40), 0);
    if (k >= 60) {
      CHECK(std::fabs(force - last) <= 1e-3 * force);
      left_out = std::max(left_out, bench.report.left_out);
      const ContactBody::Place& place = bench.report.left_out_place;
      CHECK((place.tool == 0) == (bench.report.left_out > 0));
      for (const ContactBody::Contact& contact : bench.body.contacts()) CHECK(contact.node[0] != place.node[0]);
    }
    last = force;
  }
  CHECK(left_out > 0);
}

TEST_CASE("a ball narrower than two edges slides over triangles and edges without jumps of the force") {
  for (const double friction : {0.0, 0.3}) {
    for (const double size : {1.0, 1.5}) {
      for (const double depth : {0.1, 0.3}) {
        BallOnSphere bench(64, friction);
        double last = 0, most = 0;
        for (int k = 0; k < 1000; ++k) {
          const double angle = 0.3 + 0.0008 * std::max(k - 50, 0);
          const double force = bench.press(size * bench.edge, depth * bench.edge * std::min(1.0, k / 50.0), angle);
          if (k > 70) most = std::max(most, std::fabs(force - last) / force);
          last = force;
        }
        MESSAGE("ball of ", size, " edges, ", depth, " deep, friction ", friction, ": largest step of the force ",
                100 * most, " %");
        CHECK(most <= 0.02);
      }
    }
  }
}

TEST_CASE("short of work a ball that leaps is felt at the finest level, where the field goes without details") {
  BallOnSphere bench(16, 0.3, 5);
  int pushed = 0, coarser = 0, without_details = 0;
  for (int k = 0; k < 400; ++k) {
    const double angle = 0.35 * (k / 10 % 8);
    const double force = bench.press(2.5 * bench.edge, 0.4 * bench.edge, angle, bench.requirement().least_work);
    pushed += force > 0 ? 1 : 0;
    coarser += force > 0 && bench.report.constraint_level < 4 ? 1 : 0;
    without_details += bench.report.field_level < 4 ? 1 : 0;
  }
  MESSAGE(pushed, " steps of 400 are pushed, ", coarser, " at a coarser level, ", without_details,
          " without details of the field");
  CHECK(pushed >= 360);
  CHECK(coarser == 0);
}

}  // namespace
}  // namespace greenloop
