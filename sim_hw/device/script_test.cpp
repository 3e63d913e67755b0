#include "sim_hw/device/script.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "formats/testing/synthetic_model.hpp"
#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

BodySurface sphere(double touchable_above) {
  const auto encoded = encode(synthetic_model({.levels = 4, .touchable_above = touchable_above}));
  const AlignedBytes bytes(encoded);
  const auto opened = Model::open(bytes.span());
  REQUIRE(opened);
  return body_surface(opened.model);
}

/// How deep a sphere reaches beyond the nearest node, m; negative outside.
double penetration(const BodySurface& surface, const ProbeSize& probe, const Double3& centre) {
  double nearest = norm(surface.position[0] - centre);
  for (const Double3& position : surface.position) nearest = std::min(nearest, norm(position - centre));
  return probe.radius - nearest;
}

TEST_CASE("smoothstep starts and ends at rest") {
  CHECK(smoothstep(0) == 0);
  CHECK(smoothstep(1) == 1);
  CHECK(smoothstep(0.5) == 0.5);
  CHECK(smoothstep(1e-4) < 1e-10);
  CHECK(1 - smoothstep(1 - 1e-4) < 1e-10);
}

constexpr double seconds = 10;

/// The longest way between two targets `dt` seconds apart.
double longest_step(const MotionScript& motion, double dt) {
  double longest = 0;
  for (double time = 0; time < seconds; time += dt) {
    longest = std::max(longest, norm(motion.target(time + dt).centre - motion.target(time).centre));
  }
  return longest;
}

TEST_CASE("every script goes as deep as it should, moves without jumps, and begins again") {
  const BodySurface surface = sphere(-0.2);
  const ProbeSize probe = probe_size(surface);
  for (const Script script : {Script::press, Script::slide, Script::grasp, Script::all, Script::pinch, Script::roll,
                              Script::drop, Script::flap, Script::tilt, Script::lose_messages}) {
    CAPTURE(script_names[static_cast<std::size_t>(script)]);
    const auto motions = make_script(script, surface, probe, seconds);
    const bool has_pair = script == Script::grasp || script == Script::pinch || script == Script::all;
    CHECK(motions.size() == (has_pair ? 2 : 1));
    for (const MotionScript& motion : motions) {
      double deepest = -1;
      for (double time = 0; time < seconds; time += 0.002) {
        const ProbeTarget target = motion.target(time);
        deepest = std::max(deepest, penetration(surface, probe, target.centre));
        double length = 0;
        for (const double part : target.quaternion) length += part * part;
        CHECK(length == doctest::Approx(1));
      }
      // along a slide the path is straight between places, and cuts a little into a round body
      CHECK(deepest <= 1.01 * probe.depth);
      CHECK(deepest > 0.3 * probe.depth);
      CHECK(longest_step(motion, 0.001) < 0.51 * longest_step(motion, 0.002));
      CHECK(norm(motion.target(seconds).centre - motion.target(0).centre) < 1e-9);
    }
  }
}

TEST_CASE("the random script is as long as asked for, touches in many places with both hands, and is the same again") {
  const BodySurface surface = sphere(-0.2);
  const ProbeSize probe = probe_size(surface);
  constexpr double long_run = 120;
  const auto motions = make_script(Script::random, surface, probe, long_run);
  const auto again = make_script(Script::random, surface, probe, long_run);
  REQUIRE(motions.size() == 2);
  for (std::size_t p = 0; p < 2; ++p) {
    int touches = 0;
    bool was_in = false;
    for (double time = 0; time < long_run; time += 0.01) {
      const Double3 centre = motions[p].target(time).centre;
      const double depth = penetration(surface, probe, centre);
      CHECK(depth <= 1.5 * probe.depth);
      touches += depth > 0 && !was_in ? 1 : 0;
      was_in = depth > 0;
      CHECK(norm(centre - motions[p].target(time + 0.001).centre) < 0.01);
      CHECK(centre == again[p].target(time).centre);
    }
    CHECK(touches > 10);
  }
}

TEST_CASE("grasping comes from opposite sides") {
  const BodySurface surface = sphere(-0.2);
  const ProbeSize probe = probe_size(surface);
  const auto motions = make_script(Script::grasp, surface, probe, seconds);
  REQUIRE(motions.size() == 2);
  const Double3 between = motions[0].target(5).centre - motions[1].target(5).centre;
  CHECK(norm(between) > 0.99 * surface.diagonal / std::sqrt(3.0));
}

TEST_CASE("a probe alone leaves the grasp out; each beyond the second presses a place of its own") {
  const BodySurface surface = sphere(-0.2);
  const ProbeSize probe = probe_size(surface);
  CHECK(make_script(Script::all, surface, probe, seconds, 1).size() == 1);
  CHECK_THROWS_AS((void)make_script(Script::grasp, surface, probe, seconds, 1), std::runtime_error);
  CHECK(make_script(Script::press, surface, probe, seconds, 3).size() == 2);
  const auto two = make_script(Script::all, surface, probe, seconds);
  const auto six = make_script(Script::all, surface, probe, seconds, 6);
  REQUIRE(six.size() == 6);
  for (double time = 0; time < seconds; time += 0.1) {
    for (std::size_t i = 0; i < two.size(); ++i) CHECK(six[i].target(time).centre == two[i].target(time).centre);
  }
  for (std::size_t i = 2; i < six.size(); ++i) {
    double deepest = -1;
    for (double time = 0; time < seconds; time += 0.002) {
      deepest = std::max(deepest, penetration(surface, probe, six[i].target(time).centre));
    }
    CHECK(deepest <= 1.01 * probe.depth);
    CHECK(deepest > 0.3 * probe.depth);
    for (std::size_t j = 2; j < i; ++j) CHECK(norm(six[i].target(0).centre - six[j].target(0).centre) > probe.radius);
  }
}

TEST_CASE("a small patch can be pressed; where two probes have no place, all leaves the grasp out") {
  const BodySurface surface = sphere(0.99);
  const ProbeSize probe = probe_size(surface);
  CHECK(make_script(Script::press, surface, probe, seconds).size() == 1);
  CHECK(make_script(Script::all, surface, probe, seconds).size() == 1);
  CHECK_THROWS_AS((void)make_script(Script::grasp, surface, probe, seconds), std::runtime_error);
}

}  // namespace
}  // namespace greenloop
