#include "sim_hw/transport/lock_step.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <deque>
#include <random>
#include <stdexcept>
#include <vector>

#include "sim_hw/device/haptic_device.hpp"

namespace greenloop {
namespace {

DeviceSetup still_device(std::int64_t cycles) {
  DeviceSetup setup;
  setup.motion.emplace_back(std::vector<MotionSegment>{{1, {Double3{0, 0, 0.01}}, {}, {}}}, 1.0);
  setup.cycles = cycles;
  return setup;
}

LoopCommand command_for(std::int64_t cycle) {
  LoopCommand command{};
  command.cycle = cycle;
  command.budget = 100;
  command.digest = 1000 + cycle;
  return command;
}

/// Both ends with a link between them that may lose packets, driven by hand.
struct Bench {
  explicit Bench(std::int64_t cycles) : device(still_device(cycles)) {}

  HapticDevice device;
  std::deque<DeviceState> states;
  std::deque<LoopCommand> commands;
  std::vector<std::int64_t> computed;
  LoopCommand answer{};
  DeviceEnd<HapticDevice> device_end{device, [this](const DeviceState& s) { states.push_back(s); }};
  LoopEnd<DeviceState, LoopCommand> loop_end{[this](const DeviceState& s) -> const LoopCommand& {
                                               computed.push_back(s.cycle);
                                               return answer = command_for(s.cycle);
                                             },
                                             [this](const LoopCommand& c) { commands.push_back(c); }};

  /// Delivers until both queues are empty; `lost()` says whether the next packet is.
  template <typename Lost>
  void deliver(Lost lost) {
    while (!states.empty() || !commands.empty()) {
      if (!states.empty()) {
        const auto state = states.front();
        states.pop_front();
        if (!lost()) loop_end.receive(state);
      }
      if (!commands.empty()) {
        const auto command = commands.front();
        commands.pop_front();
        if (!lost()) device_end.receive(command);
      }
    }
  }
};

TEST_CASE("on a good link every state is computed once and nothing is sent again") {
  Bench bench(50);
  bench.device_end.start();
  bench.deliver([] { return false; });
  CHECK(bench.device.finished());
  CHECK(bench.computed.size() == 50);
  CHECK(bench.device.summary().cycles == 50);
  CHECK(bench.device.summary().retransmits == 0);
  CHECK(bench.device.summary().digest == 1049);
}

TEST_CASE("lost packets are sent again, computed once, and counted") {
  constexpr std::uint64_t seed = 76;
  INFO("seed ", seed);
  std::mt19937_64 random(seed);
  Bench bench(300);
  std::int64_t losses = 0;
  const auto lost = [&] {
    const bool loss = random() % 5 == 0;
    losses += loss;
    return loss;
  };
  bench.device_end.start();
  bench.deliver(lost);
  while (!bench.device.finished()) {
    bench.device_end.silence();
    bench.deliver(lost);
  }
  CHECK(losses > 50);
  CHECK(bench.device.summary().retransmits == losses);
  CHECK(bench.device.summary().cycles == 300);
  CHECK(bench.device.summary().late == 0);
  REQUIRE(bench.computed.size() == 300);
  for (std::int64_t k = 0; k < 300; ++k) CHECK(bench.computed[static_cast<std::size_t>(k)] == k);
}

TEST_CASE("answers that come twice move the device once") {
  Bench bench(3);
  bench.device_end.start();
  bench.device_end.receive(command_for(0));
  bench.device_end.receive(command_for(0));
  bench.device_end.receive(command_for(7));
  CHECK(bench.device.summary().cycles == 1);
  CHECK(bench.device.state().cycle == 1);
}

TEST_CASE("a device without a loop gives up and says so") {
  Bench bench(3);
  bench.device_end.start();
  for (int i = 0; i < most_silences; ++i) bench.device_end.silence();
  CHECK_THROWS_AS(bench.device_end.silence(), std::runtime_error);
  CHECK(bench.device.summary().retransmits == most_silences);
}

}  // namespace
}  // namespace greenloop
