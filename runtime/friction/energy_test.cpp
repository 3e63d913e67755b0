#include "runtime/friction/energy.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/half_space.hpp"

namespace greenloop {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Double3 wide(const Vec4& v) { return {v.x, v.y, v.z}; }

/// A sphere over a half-space, and the account of its energy.
struct Pressed {
  explicit Pressed(float friction) : contacts(patch.count()) {
    for (ContactCandidate& candidate : bench.candidates) candidate.friction = friction;
    for (EnergyContact& contact : contacts) contact.normal = {0, 0, 1};
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
      contacts[i].way = {to.x() - at.x(), to.y() - at.y(), rise};
    }
    tool.step(gap, Vector3d(to.x() - at.x(), to.y() - at.y(), 0), {.residual = 1e-4F});
    for (std::uint32_t i = 0; i < patch.count(); ++i) {
      contacts[i].last_force = contacts[i].force;
      contacts[i].last_shift = contacts[i].shift;
      contacts[i].force = wide(bench.force[i]);
      contacts[i].shift = wide(bench.displacement[i]) - wide(bench.candidates[i].gap);
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

}  // namespace
}  // namespace greenloop
