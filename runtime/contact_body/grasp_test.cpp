#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/contact_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr double friction = 0.6;

// up to three balls around the waist of the synthetic sphere, which stands on its fixed bottom and knows gravity
class HeldSphere {
 public:
  HeldSphere() : model_({.levels = 4, .touchable_above = -0.4, .gravity = true}) {
    ContactBody::Limits limits;
    limits.elastostatic = {.max_contacts = 64, .cached_factors = 4, .iterations = 50, .model_loads = true};
    limits.max_tools = 3;
    memory_ = AlignedBytes(ContactBody::required(model_.model(), limits).bytes);
    const auto created = ContactBody::create(model_.model(), limits, {memory_.data(), memory_.size()});
    REQUIRE(created);
    body_ = created.body;
    const float* x = node_record(model_.view(), model_.touchable().front()).position;
    radius_ = std::sqrt(double{x[0]} * x[0] + double{x[1]} * x[1] + double{x[2]} * x[2]);
  }

  /// One step. depth: of each ball, over the sphere's radius; gravity: m/s^2, downwards. Returns N, how the balls
  /// carry.
  double hold(const std::vector<double>& depth, double gravity) {
    std::vector<ContactBody::ToolInput> tools;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const double angle = static_cast<double>(i) / static_cast<double>(depth.size()) * 6.283185307179586;
      const double distance = (1.6 - depth[i]) * radius_;
      const Double3 centre{distance * std::cos(angle), distance * std::sin(angle), 0};
      tools.push_back({{Shape::sphere(0.6 * radius_), {centre, {1, 0, 0, 0}}}, friction});
    }
    const Elastostatic::Loads loads{.gravity = {0, 0, static_cast<float>(-gravity)}};
    REQUIRE(body_.step(tools, loads, {any_budget}).status == Status::ok);
    check_laws();
    handled += std::abs(energy().in - last_in_) + std::abs(energy().from_loads - last_from_loads_);
    last_in_ = energy().in;
    last_from_loads_ = energy().from_loads;
    double up = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const Double3 force = body_.tools()[i].force;
      largest = std::max(largest, norm(force));
      if (stepped_) jump = std::max(jump, norm(force - last_[i]));
      last_[i] = force;
      up -= force.z;
    }
    stepped_ = true;
    return up;
  }

  [[nodiscard]] double felt(std::size_t ball) const { return norm(last_[ball]); }
  /// m, how far the top has come down.
  [[nodiscard]] double sunk() const {
    double least = 0;
    for (const Vec4& u : body_.displacement()) least = std::min(least, double{u.z});
    return -least;
  }

  [[nodiscard]] const ContactBody::Energy& energy() const { return body_.energy(); }

  double largest = 0, jump = 0;  ///< N, a ball's force, and its change in a step
  double handled = 0;            ///< J, by balls and gravity, in or out of each step

 private:
  void check_laws() const {
    for (const ContactBody::Contact& contact : body_.contacts()) {
      const double pressed = dot(contact.force, contact.normal);
      CHECK(pressed >= 0);
      CHECK(norm(contact.force - pressed * contact.normal) <= (friction + 1e-6) * pressed);
    }
  }

  TestModel model_;
  AlignedBytes memory_;
  ContactBody body_;
  double radius_ = 0;
  Double3 last_[3];
  bool stepped_ = false;
  double last_in_ = 0, last_from_loads_ = 0;  ///< J
};

TEST_CASE("two and three balls hold by friction what gravity pulls down; one lets go and comes back without a jump") {
  constexpr double depth = 0.04, gravity = 4;
  double carried[4] = {}, sunk[4] = {};
  for (const std::size_t balls : {std::size_t{1}, std::size_t{2}, std::size_t{3}}) {
    CAPTURE(balls);
    HeldSphere held;
    std::vector<double> deep(balls);
    double before = 0;
    for (int k = 1; k <= 100; ++k) {
      std::fill(deep.begin(), deep.end(), 0.01 * k * depth);
      before = held.hold(deep, 0);
    }
    for (int k = 1; k <= 200; ++k) carried[balls] = held.hold(deep, 0.005 * k * gravity) - before;
    sunk[balls] = held.sunk();
    for (int k = 1; k <= 250; ++k) {
      deep.back() = depth * (1 - 0.006 * k);
      held.hold(deep, gravity);
    }
    CHECK(held.felt(balls - 1) == 0);
    for (int k = 249; k >= 0; --k) {
      deep.back() = depth * (1 - 0.006 * k);
      held.hold(deep, gravity);
    }
    CHECK(held.felt(balls - 1) > 0);
    MESSAGE(balls, " balls carry ", carried[balls], " N, the body sinks by ", 1e3 * sunk[balls],
            " mm, largest step of a force ", 100 * held.jump / held.largest, " %");
    CHECK(held.jump <= 0.02 * held.largest);
    MESSAGE("of ", held.handled, " J handled, ", held.energy().from_loads, " J by gravity, do not add up ",
            held.energy().generated, " J");
    CHECK(std::abs(held.energy().from_loads) > 0.01 * held.handled);
    CHECK(held.energy().generated <= 1e-5 * held.handled);
  }
  CHECK(carried[1] > 0);
  CHECK(carried[2] > carried[1]);
  CHECK(carried[3] > carried[2]);
  CHECK(sunk[3] < sunk[2]);
  CHECK(sunk[2] < sunk[1]);
}

}  // namespace
}  // namespace greenloop
