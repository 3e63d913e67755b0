#include "sim_hw/device/haptic_device.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "sim_hw/device/encoder.hpp"

namespace greenloop {
namespace {

/// A hand that wants to stay where it is.
DeviceSetup still(std::int64_t cycles, const InjectedFaults& faults = {}) {
  DeviceSetup setup;
  setup.motion.emplace_back(std::vector<MotionSegment>{{1, {Double3{0, 0, 0}}, {}, {}}}, 1.0);
  setup.cycles = cycles;
  setup.faults = faults;
  return setup;
}

LoopCommand push(std::int64_t cycle, double force) {
  LoopCommand command{};
  command.cycle = cycle;
  command.budget = 100;
  command.work = 50;
  command.tools[0].force[2] = force;
  return command;
}

double height(const HapticDevice& device) {
  return encoder_value(device.state().tools[0].position, device.state().resolution).z;
}

TEST_CASE("a constant force moves the hand to where the spring balances it, as far as the encoder sees") {
  HapticDevice device(still(2000));
  while (!device.finished()) device.apply(push(device.state().cycle, 3));
  CHECK(std::abs(height(device) - 3 / HandParameters{}.stiffness) <= 0.5 * Coupling::resolution + 1e-12);
}

TEST_CASE("a delayed command is rendered so many cycles later") {
  DeviceSetup setup = still(100);
  setup.delay = 3;
  HapticDevice late(setup), prompt(still(100));
  std::vector<double> path[2];
  for (std::int64_t k = 0; k < 50; ++k) {
    const double force = k < 10 ? 5 : -2;
    late.apply(push(k, force));
    prompt.apply(push(k, force));
    path[0].push_back(height(late));
    path[1].push_back(height(prompt));
  }
  for (std::size_t k = 0; k + 3 < 50; ++k) CHECK(path[0][k + 3] == path[1][k]);
  CHECK(path[0][2] == 0);
  CHECK(path[1][30] != 0);
}

/// A spring in the loop, felt by a device that nobody holds: the energy that it makes, J.
DeviceSummary on_a_spring(double stiffness, bool tank) {
  constexpr double stretched = 2e-3;
  DeviceSetup setup = still(4000);
  setup.hand = hand_of(Holder::absent);
  setup.motion = {
      MotionScript({{0.1, {Double3{0, 0, stretched}, Double3{}}, {}, {}}, {10, {Double3{}}, {}, {}}}, 10.1)};
  setup.tank = {.enabled = tank, .most_damping = 25};
  HapticDevice device(setup);
  for (std::int64_t k = 0; k < 4000; ++k) {
    LoopCommand command = push(k, -stiffness * height(device));
    command.stored = 0.5 * stiffness * height(device) * height(device);
    device.apply(command);
  }
  return device.summary();
}

TEST_CASE("a spring that is too stiff for its rate makes energy, which a tank brakes; a softer one is left alone") {
  const double bound = passive_stiffness({1e-3, 0, HandParameters::device_damping});
  // what is in the spring at the start comes out, and what the hold makes, which the device's damping takes
  const double begun = 0.5 * 0.5 * bound * 2e-3 * 2e-3;
  const DeviceSummary soft = on_a_spring(0.5 * bound, false);
  CHECK(soft.delivered_most <= 3 * begun);
  const DeviceSummary wild = on_a_spring(3 * bound, false), tamed = on_a_spring(3 * bound, true);
  CHECK(wild.delivered_most > 1);
  CHECK(tamed.delivered_most < 1.05 * 6 * begun);
  CHECK(tamed.drained > 0);
}

TEST_CASE("the scales of the coupling apply to motion and force") {
  DeviceSetup setup = still(2000);
  setup.coupling = {.motion_scale = 5, .force_scale = 0.1};
  HapticDevice device(setup);
  while (!device.finished()) device.apply(push(device.state().cycle, 30));
  CHECK(height(device) == doctest::Approx(5 * 3 / HandParameters{}.stiffness).epsilon(1e-3));
}

TEST_CASE("a late command is dropped and the last one held") {
  HapticDevice faulty(still(100, {.delay_from = 40, .delay_cycles = 10}));
  HapticDevice holding(still(100));
  for (std::int64_t k = 0; k < 100; ++k) {
    const bool dropped = k >= 40 && k < 50;
    faulty.apply(push(k, dropped ? 1e6 : 2.0));
    holding.apply(push(k, 2.0));
    CHECK(faulty.state().tools[0].position[2] == holding.state().tools[0].position[2]);
  }
  CHECK(faulty.summary().late == 10);
  CHECK(faulty.summary().late_injected == 10);
  CHECK(holding.summary().late == 0);
}

TEST_CASE("twenty late commands in a row stop the device") {
  HapticDevice device(still(100, {.delay_from = 5, .delay_cycles = 90}));
  while (!device.finished()) device.apply(push(device.state().cycle, 0));
  CHECK(device.summary().stopped);
  CHECK(device.summary().cycles == 25);
}

TEST_CASE("a command over its budget is late although nothing was injected") {
  HapticDevice device(still(10));
  for (std::int64_t k = 0; k < 10; ++k) {
    LoopCommand command = push(k, 0);
    if (k == 4) command.work = 101;
    device.apply(command);
  }
  CHECK(device.summary().late == 1);
  CHECK(device.summary().late_injected == 0);
}

TEST_CASE("a stiffer body is felt scaled down so that the hand's spring still reaches in") {
  BodySurface surface;
  surface.diagonal = 0.3;
  const ProbeSize probe{.radius = 0.02, .depth = 0.015};
  layout::Info soft{};
  soft.young = 10;
  soft.poisson = 0.3;
  layout::Info stiff = soft;
  stiff.young = 1e9;
  CHECK(coupling(soft, surface, probe, {}).force_scale == 1);
  const Coupling scaled = coupling(stiff, surface, probe, {});
  CHECK(scaled.motion_scale == doctest::Approx(1.9));
  const double depth = 0.01;
  const double felt = scaled.force_scale * 4.0 / 3.0 * 1e9 / 0.91 * std::sqrt(0.02 * depth) * depth;
  CHECK(felt == doctest::Approx(0.5 * HandParameters{}.stiffness * depth / 1.9));
}

}  // namespace
}  // namespace greenloop
