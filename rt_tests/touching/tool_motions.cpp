// tool_motions [MOTIONS] [SEED]: tools that move at random, up to 10 m/s at 1 kHz and turning, through thin sheets that
// wave. A tool's point that is behind a sheet, seen from where it started, and not held in front of it has fallen
// through; and so has one that is free inside a body that it enters from anywhere. Exit status 1 if any has.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "runtime/testing/search_bench.hpp"

namespace greenloop {
namespace {

constexpr double longest_way = 0.01;  // m in a step
constexpr double rounding = 1e-7;     // m

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Double3 vector(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

double reflected(double value, double limit) {
  if (value > limit) return 2 * limit - value;
  return value < -limit ? -2 * limit - value : value;
}

// never leaves the middle of the sheets, so that no point comes around their rim, and turns by up to a tenth of a
// radian in a step
class Motion {
 public:
  explicit Motion(Random& random) : random_(random), pose_{{0.04, 0, 0}, {1, 0, 0, 0}} {}

  const Pose& next() {
    // often straight through
    Double3 way = random_.between(0, 1) < 0.5 ? Double3{random_.between(-1, 1), 0, 0} : random_.vector(1);
    way = random_.between(0, longest_way) * unit(way);
    Double3& at = pose_.position;
    at = {0.01 + reflected(at.x + way.x - 0.01, 0.04), reflected(at.y + way.y, 0.03),
          0.02 + reflected(at.z + way.z - 0.02, 0.025)};
    double length = 0;
    for (double& q : pose_.quaternion) q += random_.between(-0.05, 0.05);
    for (const double q : pose_.quaternion) length += q * q;
    for (double& q : pose_.quaternion) q /= std::sqrt(length);
    return pose_;
  }

 private:
  Random& random_;
  Pose pose_;
};

void wave(DeformedBody& body, double phase) {
  for (std::uint32_t i = 0; i < body.surface.node_count(); ++i) {
    const Double3 at = body.surface.position(i) - Double3{body.displacement[i].x, 0, 0};
    body.displacement[i].x =
        static_cast<float>(3e-3 * std::sin(30 * at.z + phase) + 2e-3 * std::cos(25 * at.y - phase));
  }
  body.update();
}

// x of the sheet's front where the line through a position along x meets it
double front(const DeformedSurface& surface, const Double3& at) {
  double most = -HUGE_VAL;
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    const auto& [i, j, k] = surface.triangle(t).node;
    const Double3 a = surface.position(i) - at, b = surface.position(j) - at, c = surface.position(k) - at;
    const double at_a = b.y * c.z - b.z * c.y, at_b = c.y * a.z - c.z * a.y, at_c = a.y * b.z - a.z * b.y;
    if (at_a < 0 || at_b < 0 || at_c < 0 || !(at_a + at_b + at_c > 0)) continue;
    most = std::max(most, at.x + (at_a * a.x + at_b * b.x + at_c * c.x) / (at_a + at_b + at_c));
  }
  return most;
}

struct Count {
  std::uint64_t behind = 0;        // points of tools that were held behind a sheet, or in a body
  std::uint64_t fallen = 0;        // those that were not
  std::uint64_t wrong_side = 0;    // held, but not in front
  std::uint64_t without_push = 0;  // steps in which a point was held and no candidate pushed
};

// false of a point that is neither clearly before the sheet nor clearly behind it
void judge(const DeformedSurface& surface, const Double3& point, const Proxy& proxy, Count& count) {
  const double height = point.x - front(surface, point);
  if (height < -rounding) {
    ++(proxy.is_held() ? count.behind : count.fallen);
    if (proxy.is_held() && !(proxy.normal().x > 0)) ++count.wrong_side;
  } else if (height > rounding && proxy.is_held()) {
    ++count.wrong_side;
  }
}

void through_sheets(const Shape& shape, float thickness, std::uint64_t motions, Random& random, Count& count) {
  DeformedBody sheet({.levels = 3, .touchable_above = -0.4}, thickness);
  SearchBench bench(sheet, {.max_points = 8, .max_candidates = 64});
  Motion motion(random);
  for (std::uint64_t i = 0; i < motions; ++i) {
    wave(sheet, 0.1 * static_cast<double>(i));
    const Pose& pose = motion.next();
    const auto found = bench.find({{shape, pose}});
    const Placement placement = place(pose).placement;
    bool is_held = false, is_pushed = false;
    for (std::uint32_t k = 0; k < shape.point_count(); ++k) {
      const Proxy& proxy = bench.search.proxy(0, k);
      judge(sheet.surface, placement.to_model(shape.point(k)), proxy, count);
      is_held = is_held || proxy.is_held();
    }
    for (const Candidate& candidate : found.candidates) is_pushed = is_pushed || candidate.gap <= 0;
    if (is_held && !is_pushed) ++count.without_push;
  }
}

// the solid angle under which the surface is seen, over 4 pi (van Oosterom & Strackee 1983)
double winding_number(const DeformedSurface& surface, const Double3& from) {
  double sum = 0;
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    const auto& [i, j, k] = surface.triangle(t).node;
    const Double3 a = unit(surface.position(i) - from), b = unit(surface.position(j) - from),
                  c = unit(surface.position(k) - from);
    sum += 2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
  }
  return sum / (4 * 3.14159265358979323846);
}

// anywhere, with jumps
void around_body(std::uint64_t motions, Random& random, Count& count) {
  DeformedBody body({.levels = 2, .touchable_above = -0.4}, 0.3F);
  SearchBench bench(body, {.max_candidates = 64});
  Double3 at{0.2, 0, 0};
  for (std::uint64_t i = 0; i < motions; ++i) {
    wave(body, 0.05 * static_cast<double>(i));
    at = random.between(0, 1) < 0.02 ? random.vector(0.2) : at + random.vector(longest_way);
    at = {reflected(at.x, 0.15), reflected(at.y, 0.15), reflected(at.z, 0.15)};
    bench.find({{Shape(), {at, {1, 0, 0, 0}}}});
    const bool is_held = bench.search.proxy(0, 0).is_held();
    if (winding_number(body.surface, at) > 0.5) ++(is_held ? count.behind : count.fallen);
  }
}

int run(std::uint64_t motions, std::uint64_t seed) {
  const Shape shapes[] = {Shape(), Shape::sphere(0.004), Shape::capsule(0.002, 0.015),
                          Shape::box({0.002, 0.01, 0.015})};
  const float thicknesses[] = {0.1F, 0.01F, 0.001F};
  Random random(seed);
  Count count;
  constexpr std::uint64_t parts = 4 * 3 + 2;
  for (const Shape& shape : shapes) {
    for (const float thickness : thicknesses) through_sheets(shape, thickness, motions / parts, random, count);
  }
  around_body(motions - 12 * (motions / parts), random, count);
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "%llu motions, seed %llu: %llu times held, %llu fallen through, %llu on the wrong side, %llu without push\n",
      number(motions), number(seed), number(count.behind), number(count.fallen), number(count.wrong_side),
      number(count.without_push));
  const bool has_tried = count.behind > motions / 10;
  return has_tried && count.fallen + count.wrong_side + count.without_push == 0 ? 0 : 1;
}

}  // namespace
}  // namespace greenloop

int main(int count, char** argument) {
  const std::uint64_t motions = count > 1 ? std::strtoull(argument[1], nullptr, 10) : 100000;
  return greenloop::run(motions, count > 2 ? std::strtoull(argument[2], nullptr, 10) : 1);
}
