#include "runtime/passivity.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>

#include "runtime/greenloop_contact.h"

namespace greenloop {
namespace {

/// A device of some mass and damping that is let go on a spring in the loop: one-sided, when it is a wall.
struct Device {
  SampledLoop loop;
  double mass = 0.1;      ///< kg
  double stiffness = 0;   ///< N/m, what is rendered
  double resolution = 0;  ///< m, of the encoder
  bool wall = false;
  double position = 1e-3;  ///< m
  double velocity = 0;

  /// Seconds of it. Returns the largest energy in the last tenth over that at the start.
  double run(EnergyTank& tank, int samples) {
    const double begun = energy();
    std::deque<double> late(1 + static_cast<std::size_t>(std::lround(loop.delay / loop.period)), position);
    double largest = 0;
    for (int k = 0; k < samples; ++k) {
      const double seen = resolution > 0 ? resolution * std::round(position / resolution) : position;
      late.push_back(seen);
      late.pop_front();
      const double depth = wall ? std::min(late.front(), 0.0) : late.front();
      const double stored = stiffness * depth * depth / 2;
      const Double3 place{seen, 0, 0};
      Double3 force{-stiffness * depth, 0, 0};
      tank.step({&place, 1}, {&force, 1}, stored);
      hold(force.x);
      if (k >= samples * 9 / 10) largest = std::max(largest, energy());
    }
    return largest / begun;
  }

  [[nodiscard]] double energy() const { return mass * velocity * velocity / 2 + stiffness * position * position / 2; }

 private:
  // a period of m x'' = force - b x', exactly
  void hold(double force) {
    const double rate = loop.damping / mass;
    const double end = force / loop.damping;
    const double decay = std::exp(-rate * loop.period);
    position += end * loop.period + (velocity - end) * (1 - decay) / rate;
    velocity = end + (velocity - end) * decay;
  }
};

TEST_CASE("a device is stable up to the stiffness that the bound of Colgate and Schenkel names, and not far beyond") {
  for (const double period : {1e-3, 2.5e-4}) {
    for (const double delay : {0.0, 1.0, 3.0}) {
      for (const double damping : {0.5, 2.0}) {
        CAPTURE(period);
        CAPTURE(delay);
        CAPTURE(damping);
        const SampledLoop loop{period, delay * period, damping};
        const double limit = passive_stiffness(loop);
        CHECK(limit == doctest::Approx(damping / (period * (0.5 + delay))));
        EnergyTank off({.enabled = false, .period = period});
        const int samples = static_cast<int>(20 / period);
        CHECK(Device{.loop = loop, .stiffness = 0.95 * limit}.run(off, samples) < 0.1);
        CHECK(Device{.loop = loop, .stiffness = 1.2 * limit}.run(off, samples) > 10);
      }
    }
  }
}

TEST_CASE("virtual damping takes what it uses from the bound, and a coupling in series keeps a body below it") {
  const SampledLoop loop{1e-3, 0, 2};
  CHECK(passive_stiffness(loop, 0.5) == doctest::Approx(3000));
  CHECK(passive_stiffness(loop, 2.5) == 0);
  const double coupling = coupling_stiffness(20000, 4000);
  CHECK(1 / (1 / coupling + 1 / 20000.0) == doctest::Approx(4000));
  CHECK(coupling_stiffness(1000, 4000) > 1e300);
}

TEST_CASE("a tank keeps devices calm that are too stiff for their rate, delay and resolution") {
  for (const double times : {1.5, 3.0}) {
    for (const double delay : {0.0, 1.0}) {
      for (const double resolution : {0.0, 1e-6}) {
        CAPTURE(times);
        CAPTURE(delay);
        CAPTURE(resolution);
        const SampledLoop loop{1e-3, delay * 1e-3, 0.5};
        Device device{.loop = loop, .stiffness = times * passive_stiffness(loop), .resolution = resolution};
        Device left_alone = device;
        EnergyTank on({.period = 1e-3, .most_damping = 50});
        EnergyTank off({.enabled = false, .period = 1e-3});
        const double begun = device.energy();
        CHECK(left_alone.run(off, 5000) > 10);
        CHECK(device.run(on, 5000) < 1);
        CHECK(on.drained() > 0);
        CHECK(on.delivered() <= 2 * begun);
      }
    }
  }
}

TEST_CASE("a tank leaves a passive loop alone") {
  const SampledLoop loop{1e-3, 0, 2};
  Device device{.loop = loop, .stiffness = 0.5 * passive_stiffness(loop)};
  Device same = device;
  EnergyTank on({.period = 1e-3, .reserve = 2 * device.energy()});
  EnergyTank off({.enabled = false, .period = 1e-3});
  device.run(on, 1000);
  same.run(off, 1000);
  CHECK(on.drained() == 0);
  CHECK(device.position == same.position);
}

TEST_CASE("what goes in at one handle may come out at another, and no more") {
  EnergyTank tank({.period = 1e-3, .reserve = 1e-6, .most_damping = 1000});
  Double3 at[2];
  double stored = 0;
  for (int k = 0; k < 2000; ++k) {
    // the first presses, then the second is pushed with twice what was stored
    const bool pressing = k < 1000;
    if (pressing) at[0].x = 1e-6 * k;
    if (!pressing) at[1].x += 2e-6;
    stored = pressing ? 500 * at[0].x * at[0].x : std::max(0.0, stored - 2e-6);
    Double3 force[2] = {{-1000 * at[0].x, 0, 0}, {pressing ? 0.0 : 1.0, 0, 0}};
    tank.step(at, force, stored);
  }
  CHECK(tank.delivered() <= 1e-6);
  CHECK(tank.lowest() >= -2e-6);
  CHECK(tank.drained() > 1e-3);
}

TEST_CASE("numbers that are not finite are not rendered, and what comes after is") {
  EnergyTank tank;
  const double bad = std::numeric_limits<double>::quiet_NaN();
  const Double3 at{1e-3, 0, 0}, nowhere{bad, 0, 0};
  Double3 force{1, 0, 0};
  tank.step({&at, 1}, {&force, 1}, 0);
  CHECK(force == Double3{1, 0, 0});
  tank.step({&nowhere, 1}, {&force, 1}, 0);
  CHECK(force == Double3{});
  force = {bad, 0, 0};
  tank.step({&at, 1}, {&force, 1}, 0);
  CHECK(force == Double3{});
  force = {2, 0, 0};
  tank.step({&at, 1}, {&force, 1}, 0);
  CHECK(force == Double3{2, 0, 0});
  CHECK(tank.delivered() == 0);
}

TEST_CASE("a tank in C is the same, bit for bit") {
  EnergyTank cpp({.period = 5e-4, .reserve = 2e-6, .most_damping = 3});
  greenloop_energy_tank c = greenloop_energy_tank_make(5e-4, 2e-6, 3);
  for (int k = 0; k < 500; ++k) {
    const Double3 at[2] = {{1e-3 * std::sin(0.1 * k), 0, 0}, {0, 2e-3 * std::cos(0.07 * k), 1e-6 * k}};
    Double3 force[2] = {{3 * std::sin(0.1 * k + 1), 1, 0}, {0, std::cos(0.05 * k), 0.1}};
    double same[6];
    std::memcpy(same, force, sizeof same);
    cpp.step(at, force, 1e-4);
    greenloop_energy_tank_step(&c, &at[0].x, same, 2, 1e-4);
    CHECK(std::memcmp(same, force, sizeof same) == 0);
  }
  CHECK(cpp.drained() > 0);
  CHECK(c.drained == cpp.drained());
  CHECK(c.level == cpp.level());
  CHECK(c.lowest == cpp.lowest());
  CHECK(c.delivered == cpp.delivered());
  CHECK(greenloop_passive_stiffness(1e-3, 0, 2, 0.5) == passive_stiffness({1e-3, 0, 2}, 0.5));
  CHECK(greenloop_coupling_stiffness(20000, 4000) == coupling_stiffness(20000, 4000));
}

}  // namespace
}  // namespace greenloop
