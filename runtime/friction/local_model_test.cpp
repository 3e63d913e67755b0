#include "runtime/friction/local_model.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/carved.hpp"
#include "runtime/testing/half_space.hpp"

namespace greenloop {
namespace {

using Eigen::Vector3d;
using Motion = Eigen::Matrix<double, 6, 1>;

constexpr double sphere_radius = 20e-3;
constexpr double depth = 4e-5;
constexpr float turn_length = 1e-3F;
constexpr ContactAccuracy tight{.residual = 1e-6F};

Vector3d vector(const Vec4& v) { return {v.x, v.y, v.z}; }
Vec4 stored(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

/// A sphere that was pressed into a half-space and dragged until some of it slips.
struct Dragged {
  explicit Dragged(double way) : bench(patch), tool(bench) {
    for (std::uint32_t i = 0; i < patch.count(); ++i) {
      bench.candidates[i].friction = 0.3F;
      points.push_back({0, stored({patch.place(i).x(), patch.place(i).y(), sphere_radius})});
      gap.push_back(patch.place(i).squaredNorm() / (2 * sphere_radius) - depth);
    }
    tool.step(gap, Vector3d::Zero(), tight);
    answer = tool.step(gap, Vector3d(way, 0, 0), tight);
    builder->build(bench.problem(), points, 1, 6, turn_length, model);
  }

  // of the body on the tool
  [[nodiscard]] Motion wrench() const {
    Motion sum = Motion::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d f = -vector(bench.force[i]);
      sum.head<3>() += f;
      sum.tail<3>() += vector(points[i].lever).cross(f);
    }
    return sum;
  }

  // solves the last step's problem for a tool elsewhere
  void move(const Motion& motion) {
    const std::vector<ContactCandidate> were = bench.candidates;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d way = motion.head<3>() + Vector3d(motion.tail<3>()).cross(vector(points[i].lever));
      bench.candidates[i].gap = stored(vector(were[i].gap) - way);
    }
    bench.solve(tight);
    bench.candidates = were;
  }

  [[nodiscard]] Motion predicted(const Motion& motion) const {
    std::array<float, 6> in;
    std::array<float, 6> out;
    for (int k = 0; k < 6; ++k) in[k] = static_cast<float>(motion[k]);
    model.evaluate(in, out);
    Motion result;
    for (int k = 0; k < 6; ++k) result[k] = out[k];
    return result;
  }

  HalfSpacePatch patch{12, 2e-3 / 12, 1e5, 0.3};
  ContactBench bench;
  MovingTool tool;
  std::vector<ToolPoint> points;
  std::vector<double> gap;
  ContactAnswer answer;
  Carved<LocalModelBuilder> builder{patch.count()};
  LocalModel model;
};

// torques count by their force at the length that turns count by
double magnitude(const Motion& wrench) {
  return std::hypot(wrench.head<3>().norm(), wrench.tail<3>().norm() / double{turn_length});
}

TEST_CASE("within its range a local model gives the forces of the whole problem, and no contact changes its state") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double way : {2e-6, 8e-6, 4e-5}) {
    CAPTURE(way);
    Dragged dragged(way);
    REQUIRE(dragged.answer.residual <= 1e-5F);
    const Motion at = dragged.wrench();
    const std::vector<ContactState> states = dragged.bench.state;
    CHECK(magnitude(dragged.predicted(Motion::Zero()) - at) <= 1e-6 * magnitude(at));
    REQUIRE(dragged.model.range > 0);
    REQUIRE(dragged.model.range < 1e-4F);
    for (int k = 0; k < 20; ++k) {
      Motion motion;
      for (double& x : motion) x = normal(random);
      motion.tail<3>() /= double{turn_length};
      std::array<float, 6> in;
      for (int c = 0; c < 6; ++c) in[c] = static_cast<float>(motion[c]);
      motion *= 0.9 * double{dragged.model.range} / double{dragged.model.motion_length(in)};
      dragged.move(motion);
      CHECK(dragged.bench.state == states);
      CHECK(magnitude(dragged.predicted(motion) - dragged.wrench()) <=
            2e-2 * magnitude(dragged.wrench() - at) + 1e-5 * magnitude(at));
    }
  }
}

TEST_CASE("beyond its range contacts do change their states") {
  for (const double way : {2e-6, 8e-6, 4e-5}) {
    Dragged dragged(way);
    const std::vector<ContactState> states = dragged.bench.state;
    int changed = 0;
    for (int c = 0; c < 6; ++c) {
      for (const double sign : {-1.0, 1.0}) {
        Motion motion = Motion::Zero();
        motion[c] = 10 * sign * double{dragged.model.range} / (c < 3 ? 1 : double{turn_length});
        dragged.move(motion);
        changed += dragged.bench.state == states ? 0 : 1;
      }
    }
    CHECK(changed > 0);
  }
}

struct FastLoopError {
  double local = 0;  ///< worst error of the local model's force, of the force
  double held = 0;   ///< of the force of the last step
};

// steps of 1 ms beside those of 125 us, pressing and dragging at so many mm/s on a curved way
FastLoopError fast_loop_error(double speed) {
  Dragged slow(0);
  Dragged fast(0);
  constexpr int rate = 8;
  const auto place = [&](int k) {
    const double t = speed * k / (1000.0 * rate);
    return Vector3d(1e-4 * std::sin(10 * t), 5e-5 * std::sin(7 * t), 1e-5 * std::sin(8 * t));
  };
  const auto gaps = [&](const Vector3d& at) {
    std::vector<double> gap;
    gap.reserve(slow.patch.count());
    for (std::uint32_t i = 0; i < slow.patch.count(); ++i) {
      gap.push_back((slow.patch.place(i) - at.head<2>()).squaredNorm() / (2 * sphere_radius) - depth - at.z());
    }
    return gap;
  };
  FastLoopError error;
  for (int k = 1; k <= 60 * rate; ++k) {
    fast.tool.step(gaps(place(k)), place(k) - place(k - 1));
    const Vector3d exact = fast.wrench().head<3>();
    if (k > rate) {
      const int since = (k - 1) / rate * rate;
      Motion motion = Motion::Zero();
      motion.head<3>() = place(k) - place(since);
      const auto of = [&](const Motion& at) { return (slow.predicted(at).head<3>() - exact).norm() / exact.norm(); };
      error.local = std::max(error.local, of(motion));
      error.held = std::max(error.held, of(Motion::Zero()));
    }
    if (k % rate == 0) {
      slow.tool.step(gaps(place(k)), place(k) - place(k - rate));
      slow.builder->build(slow.bench.problem(), slow.points, 1, 6, turn_length, slow.model);
    }
  }
  return error;
}

TEST_CASE("a loop eight times as fast feels almost what stepping the whole problem as fast would give") {
  const auto check = [](double speed, double local, double of_held) {
    const FastLoopError error = fast_loop_error(speed);
    MESSAGE("at " << speed << " mm/s the worst error is " << error.local << ", of a held force " << error.held);
    CHECK(error.local <= local);
    CHECK(error.local <= of_held * error.held);
  };
  check(1, 0.003, 0.1);
  check(3, 0.02, 0.2);
  check(10, 0.1, 0.9);  // each step slips beyond the range
}

}  // namespace
}  // namespace greenloop
