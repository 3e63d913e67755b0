#include "offline/simulate/sampling.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "formats/testing/temporary_folder.hpp"
#include "offline/simulate/state_file.hpp"

namespace greenloop::offline {
namespace {

/// A triangle on a damped spring, pushed along x either way. Dies when it has made so many steps.
class Oscillator final : public Simulator {
 public:
  explicit Oscillator(int lifetime = -1) : lifetime_(lifetime) {}

  [[nodiscard]] double time_step() const override { return 0.02; }
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const override { return triangles_; }
  [[nodiscard]] std::size_t vertices() const override { return 3; }
  void reset() override { state_ = {0, 0}; }
  void apply(std::size_t impulse) override { state_[1] += impulse == 0 ? 1 : -1; }
  void step() override {
    if (lifetime_-- == 0) throw std::runtime_error("killed");
    state_[1] -= time_step() * (100 * state_[0] + 4 * state_[1]);
    state_[0] += time_step() * state_[1];
  }
  void positions(std::span<float> out) const override {
    constexpr std::array<float, 9> rest{0, 0, 0, 1, 0, 0, 0, 1, 0};
    for (std::size_t i = 0; i < 9; ++i) out[i] = rest[i] + (i % 3 == 0 ? static_cast<float>(state_[0]) : 0.0F);
  }
  [[nodiscard]] bool at_rest() const override { return std::hypot(state_[0], state_[1] / 10) < 2e-3; }
  [[nodiscard]] std::vector<double> state() const override { return state_; }
  void restore(std::span<const double> state) override { state_.assign(state.begin(), state.end()); }

 private:
  int lifetime_;
  std::vector<double> state_{0, 0};
  std::vector<std::uint32_t> triangles_{0, 1, 2};
};

// the second impulse may only follow the first, and not rest
const std::vector<std::uint8_t> alternating{1, 1, 1, 0, 1, 0};

SamplingPlan plan(Sampling sampling) { return {sampling, 30, 6, 0.1, 0.5, 0.2, 4, 7}; }

TrajectoryWriter new_file(Simulator& simulator, const SamplingPlan& asked, const std::filesystem::path& path) {
  return TrajectoryWriter::create(path, describe(simulator, {{"right"}, {"left"}}, alternating, "{}"),
                                  room_for(asked, simulator.time_step()));
}

std::vector<float> all_frames(const TrajectoryFile& file) {
  std::vector<float> frames(file.scene().orbits.back().first_frame + file.scene().orbits.back().frames);
  frames.resize(9 * frames.size());
  file.read_frames(0, frames.size() / 9, frames);
  return frames;
}

TEST_CASE("sampled orbits are legal, as long as asked for, and start in states that were there") {
  for (const Sampling sampling : {Sampling::random, Sampling::coverage}) {
    const TemporaryFolder folder("sampling_legal");
    Oscillator simulator;
    const auto asked = plan(sampling);
    auto writer = new_file(simulator, asked, folder.path() / "t.h5");
    sample(simulator, asked, writer, folder.path() / "t.states");
    writer.close();
    const auto file = TrajectoryFile::open(folder.path() / "t.h5");
    const auto& orbits = file.scene().orbits;
    REQUIRE(orbits.size() == 36);
    const auto frames = all_frames(file);
    const auto x = [&](std::uint64_t frame) { return frames[9 * frame]; };
    int from_rest = 0, to_rest = 0, longer = 0;
    for (std::size_t i = 0; i < orbits.size(); ++i) {
      const auto& orbit = orbits[i];
      CHECK(orbit.held_out == (i < 6));
      CHECK((orbit.at_rest || orbit.frames >= 6));
      longer += orbit.frames > 26 ? 1 : 0;
      to_rest += orbit.at_rest ? 1 : 0;
      if (orbit.previous_frame < 0) {
        ++from_rest;
        CHECK(x(orbit.first_frame) == 0);
        CHECK(orbit.impulse == 0);
        continue;
      }
      const auto met = static_cast<std::uint64_t>(orbit.previous_frame) + 1;
      CHECK(x(orbit.first_frame) == x(met));
      std::size_t of = 0;
      while (met >= orbits[of].first_frame + orbits[of].frames) ++of;
      CHECK(of < i);
      CHECK(alternating[orbits[of].impulse * 2 + orbit.impulse] == 1);
      CHECK(orbits[of].held_out == orbit.held_out);
    }
    CHECK(from_rest >= 1);
    CHECK(to_rest >= 1);
    CHECK(longer >= 1);
  }
}

TEST_CASE("a run that was killed goes on with the same bits") {
  for (const Sampling sampling : {Sampling::random, Sampling::coverage}) {
    const TemporaryFolder folder("sampling_killed");
    const auto asked = plan(sampling);
    Oscillator whole, killed(500), goes_on;
    auto one = new_file(whole, asked, folder.path() / "one.h5");
    sample(whole, asked, one, folder.path() / "one.states");
    one.close();
    {
      auto two = new_file(killed, asked, folder.path() / "two.h5");
      CHECK_THROWS_WITH(sample(killed, asked, two, folder.path() / "two.states"), "killed");
    }
    auto two = TrajectoryWriter::resume(folder.path() / "two.h5");
    CHECK(!two.scene().orbits.empty());
    CHECK(two.scene().orbits.size() < 36);
    sample(goes_on, asked, two, folder.path() / "two.states");
    two.close();
    const auto a = TrajectoryFile::open(folder.path() / "one.h5"), b = TrajectoryFile::open(folder.path() / "two.h5");
    CHECK(a.scene().orbits == b.scene().orbits);
    CHECK(all_frames(a) == all_frames(b));
  }
}

/// The largest distance of a state to choose from to the nearest start, in x and v / 10, of the orbits for the model.
double largest_gap(const TrajectoryFile& file) {
  const auto frames = all_frames(file);
  struct Point {
    double x, v;
  };
  const auto point = [&](std::uint64_t frame, std::int64_t before) {
    const double x = frames[9 * frame];
    return Point{x, before < 0 ? 0 : (x - frames[9 * static_cast<std::uint64_t>(before)]) / 0.02 / 10};
  };
  std::vector<Point> starts;
  for (const auto& orbit : file.scene().orbits) {
    if (!orbit.held_out && orbit.impulse == 0) starts.push_back(point(orbit.first_frame, orbit.previous_frame));
  }
  double largest = 0;
  for (const auto& orbit : file.scene().orbits) {
    if (!orbit.held_out) continue;
    for (std::uint64_t f = orbit.first_frame + 5; f < orbit.first_frame + orbit.frames; ++f) {
      const Point at = point(f, static_cast<std::int64_t>(f) - 1);
      double nearest = 1e9;
      for (const Point& start : starts) nearest = std::min(nearest, std::hypot(at.x - start.x, at.v - start.v));
      largest = std::max(largest, nearest);
    }
  }
  return largest;
}

TEST_CASE("coverage leaves smaller gaps than chance") {
  const auto gap = [](Sampling sampling) {
    const TemporaryFolder folder("sampling_gap");
    Oscillator simulator;
    auto asked = plan(sampling);
    asked.orbits = 60;
    auto writer = new_file(simulator, asked, folder.path() / "t.h5");
    sample(simulator, asked, writer, folder.path() / "t.states");
    writer.close();
    return largest_gap(TrajectoryFile::open(folder.path() / "t.h5"));
  };
  const double random = gap(Sampling::random), coverage = gap(Sampling::coverage);
  CAPTURE(random);
  CHECK(coverage < 0.8 * random);
}

TEST_CASE("a goal of replay ends sampling, a stricter one later") {
  for (const Sampling sampling : {Sampling::random, Sampling::coverage}) {
    const auto orbits = [&](double goal) {
      const TemporaryFolder folder("sampling_goal");
      Oscillator simulator;
      const SamplingPlan asked{sampling, 100, 20, 0.1, 0.5, 0.2, 4, 1, {}, goal};
      auto writer = new_file(simulator, asked, folder.path() / "t.h5");
      const auto error = sample(simulator, asked, writer, folder.path() / "t.states");
      REQUIRE(error);
      CHECK(*error <= goal);
      return writer.scene().orbits.size() - 20;
    };
    const auto loose = orbits(0.3);
    CHECK(loose < 100);
    const auto strict = orbits(0.15);
    CHECK(strict > loose);
    MESSAGE(std::string(sampling == Sampling::random ? "random: " : "coverage: ")
            << loose << " orbits until half of those held out replay with 30 %, " << strict << " with 15 %");
  }
}

TEST_CASE("more orbits replay better, by chance as by coverage") {
  constexpr std::size_t runs = 5;
  for (const Sampling sampling : {Sampling::random, Sampling::coverage}) {
    double before = 1;
    for (const std::uint32_t orbits : {5U, 20U, 80U}) {
      std::vector<double> errors;
      for (std::uint64_t seed = 1; seed <= runs; ++seed) {
        const TemporaryFolder folder("sampling_curve");
        Oscillator simulator;
        const SamplingPlan asked{sampling, orbits, 20, 0.1, 0.5, 0.2, 4, seed};
        auto writer = new_file(simulator, asked, folder.path() / "t.h5");
        errors.push_back(sample(simulator, asked, writer, folder.path() / "t.states").value());
      }
      std::nth_element(errors.begin(), errors.begin() + runs / 2, errors.end());
      MESSAGE(std::string(sampling == Sampling::random ? "random: " : "coverage: ")
              << orbits << " orbits, median replay error of " << runs << " runs " << 100 * errors[runs / 2] << " %");
      CHECK(errors[runs / 2] < before);
      before = errors[runs / 2];
    }
    CHECK(before < 0.15);
  }
}

TEST_CASE("refused: plans that contradict themselves, states of something else") {
  const TemporaryFolder folder("sampling_refused");
  auto asked = plan(Sampling::random);
  asked.longest = 0.05;
  CHECK_THROWS_AS(static_cast<void>(room_for(asked, 0.02)), std::invalid_argument);
  asked = plan(Sampling::random);
  asked.held_out = 0;
  asked.replay_goal = 0.1;
  CHECK_THROWS_WITH(static_cast<void>(room_for(asked, 0.02)), doctest::Contains("needs orbits that are held out"));
  const auto path = folder.path() / "s.states";
  StateFile(path, 2, 0).append(3, std::array{1.0, 2.0});
  CHECK(StateFile(path, 2, 4).read(0) == std::vector{1.0, 2.0});
  CHECK(StateFile(path, 2, 3).frames().empty());
  CHECK_THROWS_WITH(StateFile(path, 3, 4), doctest::Contains("holds no states of this simulation"));
  CHECK_THROWS_WITH(StateFile(folder.path() / "none.states", 2, 4), doctest::Contains("--overwrite"));
}

}  // namespace
}  // namespace greenloop::offline
