#include "sim_hw/control_loop/control_loop.hpp"

#include <doctest/doctest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "formats/testing/synthetic_model.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/model.hpp"
#include "runtime/newest.hpp"
#include "sim_hw/body/body_surface.hpp"
#include "sim_hw/control_loop/loop_thread.hpp"
#include "sim_hw/control_loop/run_log.hpp"
#include "sim_hw/device/encoder.hpp"
#include "sim_hw/guard/guarded.hpp"
#include "sim_hw/session/hosted_contact_body.hpp"

namespace greenloop {
namespace {

constexpr double probe_radius = 0.03, sphere_radius = 0.1;
constexpr std::uint32_t max_contacts = 16;

const std::vector<std::byte>& synthetic_file() {
  static const std::vector<std::byte> file = encode(synthetic_model({.levels = 5, .touchable_above = -0.2}));
  return file;
}

/// The synthetic sphere with a loop on it.
struct Bench {
  explicit Bench(LoopSetup setup = {}) : bytes(synthetic_file()) {
    const auto opened = Model::open(bytes.span());
    REQUIRE(opened);
    model = opened.model;
    surface = body_surface(model);
    ContactBody::Limits limits;
    limits.elastostatic = {.max_contacts = max_contacts, .iterations = 50};
    limits.max_tools = max_tools;
    limits.max_points = 1;
    body.emplace(model, limits);
    setup.probe_radius = probe_radius;
    if (setup.budget.work == 0) setup.budget.work = 2000000;
    loop = std::make_unique<ControlLoop>(body->body(), setup);
  }

  AlignedBytes bytes;
  Model model;
  BodySurface surface;
  std::optional<HostedContactBody> body;
  std::unique_ptr<ControlLoop> loop;
};

/// A probe from above, `depth` m into the top of the sphere.
DeviceState pressed(std::int64_t cycle, double depth) {
  DeviceState state{};
  state.cycle = cycle;
  state.resolution = 1e-6;
  state.num_tools = 1;
  state.tools[0].position[2] = encoder_counts(sphere_radius + probe_radius - depth, state.resolution);
  return state;
}

TEST_CASE("without touching there is no force, and the answer belongs to its cycle") {
  Bench bench;
  LoopCommand command{};
  bench.loop->cycle(pressed(41, -0.01));
  bench.loop->answer(command);
  CHECK(command.cycle == 41);
  for (std::uint32_t i = 0; i < command.num_contacts; ++i) CHECK(command.contacts[i].force[2] == 0);
  CHECK(command.tools[0].force[2] == 0);
  CHECK(command.budget == 2000000);
}

TEST_CASE("the hand is pushed back out with what holds the contacts") {
  Bench bench;
  LoopCommand command{};
  for (std::int64_t k = 0; k < 10; ++k) {
    bench.loop->cycle(pressed(k, 0.005));
    bench.loop->answer(command);
  }
  REQUIRE(static_cast<Status>(command.status) == Status::ok);
  REQUIRE(command.num_contacts > 0);
  CHECK(command.tools[0].force[2] > 0);
  double sum = 0;
  for (std::uint32_t i = 0; i < command.num_contacts; ++i) {
    CHECK(command.contacts[i].force[2] <= 0);
    sum += static_cast<double>(command.contacts[i].force[2]);
  }
  CHECK(command.tools[0].force[2] == doctest::Approx(-sum));
}

TEST_CASE("what pushes lies on the probe in the deformed field, and no touchable node lies inside it") {
  Bench bench;
  for (std::int64_t k = 0; k < 20; ++k) bench.loop->cycle(pressed(k, 0.005));
  const Double3 centre = bench.loop->tools()[0].tool.pose.position;
  const auto distance = [&](std::uint32_t node) {
    const Vec4& moved = bench.loop->field()[node];
    return norm(bench.surface.position[node] + Double3{moved.x, moved.y, moved.z} - centre);
  };
  std::size_t pushing = 0;
  for (const ContactBody::Contact& contact : bench.loop->contacts()) {
    if (contact.state == ContactState::open) continue;
    ++pushing;
    CHECK(norm(contact.position - centre) == doctest::Approx(probe_radius).epsilon(0.01));
  }
  CHECK(pushing > 0);
  for (std::uint32_t node = 0; node < bench.surface.position.size(); ++node) {
    if (bench.surface.touchable[node]) CHECK(distance(node) > 0.99 * probe_radius);
  }
}

TEST_CASE("a state that is not finite is refused, and the hands keep the last good force") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Bench bench;
  LoopCommand good{}, refused{};
  bench.loop->cycle(pressed(0, 0.005));
  bench.loop->answer(good);
  REQUIRE(good.tools[0].force[2] > 0);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity, 1e300}) {
    DeviceState state = pressed(1, 0.005);
    state.resolution = bad;
    bench.loop->cycle(state);
    bench.loop->answer(refused);
    CHECK(static_cast<Status>(refused.status) == Status::held_not_finite);
    CHECK(refused.tools[0].force[2] == good.tools[0].force[2]);
    state = pressed(1, 0.005);
    state.origin[1] = bad;
    bench.loop->cycle(state);
    CHECK(bench.loop->report().status == Status::held_not_finite);
  }
  bench.loop->cycle(pressed(2, 0.005));
  CHECK(bench.loop->report().status == Status::ok);
}

TEST_CASE("a step that is refused counts as held") {
  Bench bench({.budget = {.work = 1}});
  bench.loop->cycle(pressed(0, 0.005));
  CHECK(bench.loop->report().status == Status::held_over_budget);
  CHECK_FALSE(answered(bench.loop->report().status));
  CHECK(bench.loop->answers().empty());
}

TEST_CASE("the overrun of the negative control spends more than the budget, in its cycle only") {
  Bench bench({.budget = {.work = 500000}, .overrun_cycle = 3});
  for (std::int64_t k = 0; k < 6; ++k) {
    bench.loop->cycle(pressed(k, 0.005));
    CHECK((bench.loop->report().work > 500000) == (k == 3));
  }
}

TEST_CASE("contacts, step, answer and hand-over use no heap, no lock and no system call") {
  const bool watched = system_call_guard::install();
  if (!watched) MESSAGE("the kernel offers no Syscall User Dispatch: system calls are not counted");
  Bench bench;
  Newest<DeviceState> states;
  Newest<LoopCommand> commands;
  DeviceState state{};
  LoopCommand command{};
  GuardCounts total;
  for (std::int64_t k = 0; k < 200; ++k) {
    total += guarded([&] {
      states.put(pressed(k, 0.00005 * static_cast<double>(k) - 0.002));
      if (!states.take(state)) return;
      bench.loop->cycle(state);
      bench.loop->answer(command);
      commands.put(command);
    });
  }
  CHECK(command.num_contacts > 0);
  CHECK(total.allocations == 0);
  CHECK(total.locks == 0);
  CHECK(total.system_calls == 0);
}

TEST_CASE("the counters do count in a section that does all three") {
  const bool watched = system_call_guard::install();
  std::mutex mutex;
  std::vector<int> grown;
  const GuardCounts seen = guarded([&] {
    const std::lock_guard lock(mutex);
    grown.resize(1000);
    (void)syscall(SYS_getppid);
  });
  CHECK(seen.allocations > 0);
  CHECK(seen.locks > 0);
  if (watched) CHECK(seen.system_calls > 0);
}

TEST_CASE("the loop's thread answers every state in order and logs it") {
  Bench bench;
  RunLog log(100, bench.surface.position.size());
  {
    LoopThread thread(*bench.loop, log);
    for (std::int64_t k = 0; k < 100; ++k) {
      const auto& command = thread.answer(pressed(k, 0.0001 * static_cast<double>(k) - 0.002));
      CHECK(command.cycle == k);
    }
    CHECK(thread.allocations() == 0);
  }
  REQUIRE(log.records().size() == 100);
  for (std::size_t k = 0; k < 100; ++k) CHECK(log.records()[k].cycle == static_cast<std::int64_t>(k));
  CHECK(log.records().back().contacts > 0);
}

}  // namespace
}  // namespace greenloop
