#include "sim_hw/device/hand.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace greenloop {
namespace {

/// Underdamped oscillator that starts at rest, displaced by `x0` from its equilibrium.
double damped_oscillation(const HandParameters& p, double x0, double time) {
  const double decay = p.damping / (2 * p.mass);
  const double omega = std::sqrt(p.stiffness / p.mass - decay * decay);
  return x0 * std::exp(-decay * time) * (std::cos(omega * time) + decay / omega * std::sin(omega * time));
}

double worst_error(double dt, double duration) {
  const HandParameters p;
  const Double3 target{0.01, 0, 0}, force{0, 3, 0};
  const Double3 equilibrium{0.01, 3 / p.stiffness, 0};
  Hand hand(p, {0.03, 0, 0});
  double worst = 0;
  const int steps = static_cast<int>(std::lround(duration / dt));
  for (int i = 1; i <= steps; ++i) {
    hand.advance({target, target, target}, force, dt);
    const double x = equilibrium.x + damped_oscillation(p, 0.02, i * dt);
    const double y = equilibrium.y + damped_oscillation(p, -equilibrium.y, i * dt);
    worst = std::max({worst, std::abs(hand.position().x - x), std::abs(hand.position().y - y)});
  }
  return worst;
}

TEST_CASE("a released hand follows the closed form of the damped oscillator") { CHECK(worst_error(1e-3, 0.5) < 1e-8); }

TEST_CASE("the integration is of fourth order") {
  const double ratio = worst_error(4e-3, 0.4) / worst_error(2e-3, 0.4);
  CHECK(ratio > 12);
  CHECK(ratio < 22);
}

TEST_CASE("a hand that follows a uniformly moving target lags by damping times speed over stiffness") {
  const HandParameters p;
  Hand hand(p, {});
  constexpr double dt = 1e-3, speed = 0.05;
  for (int i = 0; i < 1000; ++i) {
    const auto at = [&](double fraction) { return Double3{speed * (i + fraction) * dt, 0, 0}; };
    hand.advance({at(0), at(0.5), at(1)}, {}, dt);
  }
  CHECK(hand.velocity().x == doctest::Approx(speed).epsilon(1e-9));
  CHECK(speed - hand.position().x == doctest::Approx(p.damping * speed / p.stiffness).epsilon(1e-9));
}

}  // namespace
}  // namespace greenloop
