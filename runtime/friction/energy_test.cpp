#include "runtime/friction/energy.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <deque>
#include <random>
#include <vector>

#include "runtime/testing/half_space.hpp"

namespace greenloop {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vec4 difference(const Vec4& a, const Vec4& b) { return {a.x - b.x, a.y - b.y, a.z - b.z, 0}; }

/// A sphere over a half-space, and the account of its energy.
struct Pressed {
  explicit Pressed(float friction) : contacts(patch.count()) {
    for (ContactCandidate& candidate : bench.candidates) candidate.friction = friction;
    for (EnergyContact& contact : contacts) contact.normal = {0, 0, 1, 0};
  }

  void move(const Vector3d& to) {
    std::vector<double> gap;
    gap.reserve(patch.count());
    for (std::uint32_t i = 0; i < patch.count(); ++i) {
      gap.push_back((patch.place(i) - to.head<2>()).squaredNorm() / (2 * 20e-3) - to.z());
    }
    // the tool's point over each cell: its surface rises where the sphere comes nearer
    for (std::uint32_t i = 0; i < patch.count(); ++i) {
      const double rise = begun ? last_gap[i] - gap[i] : 0;
      contacts[i].way = {static_cast<float>(to.x() - at.x()), static_cast<float>(to.y() - at.y()),
                         static_cast<float>(rise), 0};
    }
    tool.step(gap, Vector3d(to.x() - at.x(), to.y() - at.y(), 0), {.residual = 1e-4F});
    for (std::uint32_t i = 0; i < patch.count(); ++i) {
      contacts[i].last_force = contacts[i].force;
      contacts[i].last_shift = contacts[i].shift;
      contacts[i].force = bench.force[i];
      contacts[i].shift = difference(bench.displacement[i], bench.candidates[i].gap);
    }
    if (begun) account.add(contacts);
    at = to;
    last_gap = gap;
    begun = true;
  }

  HalfSpacePatch patch{10, 2e-4, 1e5, 0.3};
  ContactBench bench{patch};
  MovingTool tool{bench};
  std::vector<EnergyContact> contacts;
  EnergyAccount account;
  Vector3d at = Vector3d(0, 0, -1e-4);
  std::vector<double> last_gap;
  bool begun = false;
};

TEST_CASE("whatever a tool does, it gets out no more than it put in, and all of it is accounted for") {
  for (const float friction : {0.0F, 0.4F}) {
    CAPTURE(friction);
    Pressed pressed(friction);
    pressed.move(pressed.at);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> drawn(-1, 1);
    double handled = 0;
    EnergyAccount last;
    for (int k = 0; k < 2000; ++k) {
      const Vector3d jump(1e-4 * drawn(random), 1e-4 * drawn(random), 4e-5 * drawn(random));
      pressed.move(k % 10 == 0 ? jump : Vector3d(pressed.at + 0.1 * jump));
      const EnergyAccount& now = pressed.account;
      handled += std::abs(now.in - last.in);
      CHECK(now.stored >= 0);
      CHECK(now.dissipated - last.dissipated >= -2e-4 * handled / (k + 1));
      CHECK(now.lost - last.lost >= -2e-4 * handled / (k + 1));
      CHECK(now.in >= now.stored - 1e-6 * handled);
      last = now;
    }
    CHECK(std::abs(pressed.account.generated()) <= 1e-6 * handled);
    CHECK((friction > 0) == (pressed.account.dissipated > 0.01 * handled));
    // lifted, nothing is stored
    pressed.move(Vector3d(0, 0, -1e-4));
    CHECK(pressed.account.stored == 0);
    CHECK(pressed.account.in >= 0);
    CHECK(std::abs(pressed.account.generated()) <= 1e-6 * handled);
  }
}

TEST_CASE("pressed in small steps, what a tool puts in is what is stored, and comes back") {
  Pressed pressed(0);
  pressed.move(Vector3d::Zero());
  constexpr int steps = 200;
  for (int k = 1; k <= steps; ++k) pressed.move(Vector3d(0, 0, 4e-5 * k / steps));
  // Hertz: 2/5 of force times depth
  const double force = 4.0 / 3 * pressed.patch.plane_modulus() * std::sqrt(20e-3 * 4e-5) * 4e-5;
  CHECK(pressed.account.stored == doctest::Approx(0.4 * force * 4e-5).epsilon(0.02));
  CHECK(pressed.account.in == doctest::Approx(pressed.account.stored).epsilon(0.02));
  for (int k = steps - 1; k >= 0; --k) pressed.move(Vector3d(0, 0, 4e-5 * k / steps));
  CHECK(pressed.account.in <= 0.04 * force * 4e-5);
  CHECK(pressed.account.in >= 0);
}

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
      const Vec3 wanted{static_cast<float>(-stiffness * depth), 0, 0};
      const double force = tank.step({static_cast<float>(seen), 0, 0}, wanted, stored).x;
      hold(force);
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

}  // namespace
}  // namespace greenloop
