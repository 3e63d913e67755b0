#include "sim_hw/motion/motion_loop.hpp"

#include <doctest/doctest.h>

#include <set>

#include "formats/testing/synthetic_motion.hpp"
#include "sim_hw/motion/impulse_device.hpp"

namespace greenloop {
namespace {

// a loop and what it lives on
struct Bench {
  ModelFile file = encoded_file(synthetic_motion({.alternating = true}));
  Model model = Model::open(file.bytes.span()).model;
  ImpulseResponse::Requirement need = ImpulseResponse::required(model, {});
  AlignedBytes memory{need.bytes};
  MotionLoop loop{model,
                  ImpulseResponse::create(model, {}, {memory.data(), memory.size()}).body,
                  {.budget = {need.frame_work}, .field_every = 4}};
};

TEST_CASE("an impulse that may not follow, or is none, leaves state and place as they were") {
  Bench bench;
  MotionCommand command;
  std::int64_t cycle = 0;
  const auto give = [&](std::int32_t impulse) {
    bench.loop.cycle({cycle++, impulse});
    bench.loop.answer(command);
    return static_cast<Status>(command.status);
  };
  CHECK(give(1) == Status::ok);
  CHECK(command.rank == 6);
  for (int i = 0; i < 5; ++i) CHECK(give(-1) == Status::ok);
  CHECK(command.num_modes == 6);
  CHECK(command.orbit > 0);
  const MotionCommand before = command;
  CHECK(give(1) == Status::held_illegal_impulse);
  CHECK(give(77) == Status::held_out_of_range);
  CHECK(command.orbit == before.orbit);
  CHECK(command.row == before.row);
  CHECK(std::equal(command.coordinate, command.coordinate + 6, before.coordinate));
  CHECK(command.digest != before.digest);
  CHECK(give(0) == Status::ok);
  CHECK(command.orbit != before.orbit);
}

TEST_CASE("the device gives the same impulses in every run, of the palette and beyond it, and some in a row") {
  const auto run = [](std::uint64_t seed) {
    ImpulseDevice device({.impulses = 3, .rate = 1000, .cycles = 60000, .seed = seed});
    std::vector<std::int64_t> given;
    for (; !device.finished(); device.apply({.cycle = device.state().cycle, .work = 1, .budget = 1})) {
      if (device.state().impulse >= 0) given.push_back(10 * device.state().cycle + device.state().impulse);
    }
    return given;
  };
  const std::vector<std::int64_t> given = run(1);
  CHECK(given == run(1));
  CHECK(given != run(2));
  CHECK(given.size() > 100);
  std::set<std::int64_t> impulses;
  bool close = false, far = false;
  for (std::size_t i = 0; i < given.size(); ++i) {
    impulses.insert(given[i] % 10);
    const std::int64_t apart = i == 0 ? 100 : given[i] / 10 - given[i - 1] / 10;
    close = close || apart < 25;
    far = far || apart > 400;
  }
  CHECK(impulses == std::set<std::int64_t>{0, 1, 2, 3});
  CHECK((close && far));
}

}  // namespace
}  // namespace greenloop
