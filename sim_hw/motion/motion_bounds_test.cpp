#include "sim_hw/motion/motion_bounds.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "formats/testing/synthetic_motion.hpp"
#include "formats/write/model_file.hpp"

namespace greenloop {
namespace {

double norm_of(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t m = 0; m < a.size(); ++m) {
    sum += (static_cast<double>(a[m]) - static_cast<double>(b[m])) *
           (static_cast<double>(a[m]) - static_cast<double>(b[m]));
  }
  return std::sqrt(sum);
}

struct Extremes {
  double displacement = 0, velocity = 0, displacement_jump = 0, velocity_jump = 0;
};

// the last impulse that may follow, again and again
Extremes pushed(const Model& model, const ImpulseResponse::Limits& limits, int steps, int apart) {
  AlignedBytes memory(ImpulseResponse::required(model, limits).bytes);
  auto created = ImpulseResponse::create(model, limits, {memory.data(), memory.size()});
  REQUIRE(created);
  const std::uint32_t modes = model.view().impulse_response.modes;
  std::vector<float> u(modes), v(modes), u_before(modes), v_before(modes);
  const std::vector<float> rest(modes);
  Extremes most;
  for (int i = 0; i < steps; ++i) {
    std::uint32_t impulse = ImpulseResponse::no_impulse;
    for (std::uint32_t k = 0; k < model.view().impulse_response.info->impulses && i % apart == 0; ++k) {
      if (created.body.may_follow(k)) impulse = k;
    }
    CHECK(answered(created.body.step(impulse, {1U << 30U}, {u, v, {}, {}, {}}).status));
    most = {std::max(most.displacement, norm_of(u, rest)), std::max(most.velocity, norm_of(v, rest)),
            std::max(most.displacement_jump, norm_of(u, u_before)), std::max(most.velocity_jump, norm_of(v, v_before))};
    u_before = u;
    v_before = v;
  }
  return most;
}

TEST_CASE("no state is farther away, and none jumps farther, than is said before") {
  const ModelFile file = encoded_file(synthetic_motion({}));
  const Model model = Model::open(file.bytes.span()).model;
  for (const float rate : {1000.0F, 128.0F, 30.0F}) {
    const ImpulseResponse::Limits limits{.rate = rate};
    const MotionBounds bounds = motion_bounds(model, limits);
    for (const int apart : {1, 3, 20, 200}) {
      CAPTURE(rate);
      CAPTURE(apart);
      const Extremes most = pushed(model, limits, 2000, apart);
      CHECK(most.displacement <= 1.0001 * bounds.displacement.reach());
      CHECK(most.velocity <= 1.0001 * bounds.velocity.reach());
      CHECK(most.displacement_jump <= 1.0001 * bounds.displacement.jump());
      CHECK(most.velocity_jump <= 1.0001 * bounds.velocity.jump());
      CHECK(most.displacement > 0.05 * bounds.displacement.most);
    }
  }
}

TEST_CASE("what an orbit does by itself reaches the bound of its states") {
  const ModelFile file = encoded_file(synthetic_motion({.impulses = 1, .orbits = 1}));
  const Model model = Model::open(file.bytes.span()).model;
  const MotionBounds bounds = motion_bounds(model, {});
  const Extremes most = pushed(model, {}, 400, 1000);
  CHECK(most.displacement > 0.95 * bounds.displacement.most);
  CHECK(most.velocity > 0.95 * bounds.velocity.most);
}

}  // namespace
}  // namespace greenloop
