#include "runtime/contact/candidate_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "runtime/algebra/fnv1a.hpp"
#include "runtime/testing/deformed_body.hpp"
#include "runtime/testing/search_bench.hpp"

namespace greenloop {
namespace {

constexpr CandidateSearch::Limits usual{.max_tools = 3, .max_points = 8, .max_candidates = 512, .margin = 1e-3};
constexpr SyntheticOptions body_options{.levels = 4, .touchable_above = -0.4};

Pose at(const Double3& position) { return {position, {1, 0, 0, 0}}; }

const std::vector<std::pair<std::string, Shape>> shapes{{"point", Shape()},
                                                        {"sphere", Shape::sphere(0.008)},
                                                        {"needle's tip", Shape::sphere(1e-4)},
                                                        {"capsule", Shape::capsule(0.004, 0.02)},
                                                        {"box", Shape::box({0.004, 0.02, 0.012})}};

TEST_CASE("candidates: the touchable nodes that are near a resting tool, with its distance and normal") {
  const DeformedBody body(body_options);
  SearchBench bench(body, usual);
  const Shape shape = Shape::sphere(0.05);
  const Tool tool{shape, at({0.13, 0, 0.01})};
  for (int step = 0; step < 2; ++step) {
    std::set<std::uint32_t> expected, found;
    for (std::uint32_t i = 0; i < body.surface.node_count(); ++i) {
      const Double3 offset = body.surface.position(i) - tool.pose.position;
      if (body.surface.is_touchable(i) && norm(offset) - 0.05 <= usual.margin) expected.insert(i);
    }
    for (const Candidate& candidate : bench.find({tool}).candidates) {
      const Double3 offset = candidate.position - tool.pose.position;
      CHECK(norm(candidate.normal - unit(offset)) < 1e-12);
      if (candidate.triangle != layout::none) {
        CHECK(candidate.gap == doctest::Approx(norm(offset) - 0.05).epsilon(1e-9));
        CHECK(candidate.feature == 0);
        continue;
      }
      found.insert(candidate.node[0]);
      CHECK(candidate.gap == doctest::Approx(norm(offset) - 0.05).epsilon(1e-9));
    }
    CHECK(expected.size() > 8);
    CHECK(found == expected);
  }
}

TEST_CASE("candidates: a plane's are all that are behind it, and it has no points to follow") {
  const DeformedBody body(body_options);
  SearchBench bench(body, usual);
  const double s = std::sqrt(0.5);
  // the half space x >= 0.09: its z axis points along -x
  const auto found = bench.find({{Shape::plane(), {{0.09, 0, 0}, {s, 0, -s, 0}}}}).candidates;
  std::size_t expected = 0;
  for (std::uint32_t i = 0; i < body.surface.node_count(); ++i) {
    expected += body.surface.is_touchable(i) && body.surface.position(i).x >= 0.09 - usual.margin ? 1 : 0;
  }
  CHECK(found.size() == expected);
  for (const Candidate& candidate : found) {
    CHECK(candidate.normal.x == doctest::Approx(-1));
    CHECK(candidate.gap == doctest::Approx(0.09 - candidate.position.x).epsilon(1e-9));
  }
}

TEST_CASE("candidates: a gap changes by what tool and body move along the normal") {
  const DeformedBody body(body_options);
  SearchBench bench(body, usual);
  const Shape shape = Shape::sphere(0.05);
  bench.find({{shape, at({0.149, 0, 0})}});
  const Double3 moved{-1e-5, 2e-5, 0};
  const auto found = bench.find({{shape, at(Double3{0.149, 0, 0} + moved)}}).candidates;
  REQUIRE(!found.empty());
  for (const Candidate& candidate : found) {
    if (candidate.triangle != layout::none) continue;
    const double before = norm(candidate.position - Double3{0.149, 0, 0}) - 0.05;
    CHECK(candidate.gap == doctest::Approx(before - dot(moved, candidate.normal)).epsilon(1e-4));
  }
}

TEST_CASE("candidates: every shape that passes the thin ear in one step is stopped on the side that it came from") {
  const DeformedBody ear({.levels = 4, .touchable_above = -0.4}, 0.01F);
  for (const auto& some : shapes) {
    const Shape& shape = some.second;
    CAPTURE(some.first);
    for (const double side : {1.0, -1.0}) {
      SearchBench bench(ear, usual);
      bench.find({{shape, at({side * 0.03, 0.01, 0.03})}});
      const Candidate* deepest = nullptr;
      const auto found = bench.find({{shape, at({side * -0.03, 0.012, 0.03})}}).candidates;
      for (const Candidate& candidate : found) {
        if (deepest == nullptr || candidate.gap < deepest->gap) deepest = &candidate;
        if (candidate.gap < -0.02) CHECK(side * candidate.normal.x < -0.3);
      }
      REQUIRE(deepest != nullptr);
      CHECK(deepest->gap < -0.029);
      CHECK(side * deepest->normal.x < -0.9);
    }
  }
}

TEST_CASE("candidates: nodes behind the part that a tool touches are left out") {
  const DeformedBody ear({.levels = 4, .touchable_above = -0.4}, 0.002F);  // no thicker than the margin
  SearchBench bench(ear, usual);
  const auto found = bench.find({{Shape::sphere(1), at({1.0002, 0.01, 0.02})}}).candidates;
  CHECK(found.size() > 3);
  for (const Candidate& candidate : found) {
    CHECK(candidate.normal.x < -0.9);
    CHECK(candidate.position.x >= 0);
  }
}

TEST_CASE("candidates: a node that slides off a box's edge is free") {
  const DeformedBody body(body_options);
  SearchBench bench(body, {.max_points = 8, .max_candidates = 64, .margin = 0});
  const Shape box = Shape::box({0.01, 0.01, 0.01});
  // the node at the top lies on the box's lower face, near its edge, then beside it
  const Double3 top = body.surface.position(4);
  REQUIRE(top.z == doctest::Approx(0.1));
  bench.find({{box, at(top + Double3{0.0099, 0, 0.01})}});
  for (const Candidate& candidate : bench.find({{box, at(top + Double3{0.0102, 0, 0.0099})}}).candidates) {
    CHECK((candidate.node[0] != 4 || candidate.triangle != layout::none));
  }
}

TEST_CASE("candidates: of too many the deepest are kept, and the deepest of the others is named") {
  const DeformedBody body(body_options);
  SearchBench all(body, usual);
  const std::vector<Tool> tools{{Shape::sphere(0.06), at({0.14, 0, 0.02})}, {Shape::sphere(0.05), at({0, 0.13, 0.02})}};
  const auto first = all.find(tools).candidates;
  std::vector<Candidate> sorted(first.begin(), first.end());
  REQUIRE(sorted.size() > 20);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.gap < b.gap; });
  for (const std::uint32_t room : {1U, 2U, 7U, 20U}) {
    SearchBench few(body, {.max_tools = 3, .max_points = 8, .max_candidates = room, .margin = 1e-3});
    const auto found = few.find(tools);
    REQUIRE(found.candidates.size() == room);
    CHECK(found.left_out == sorted.size() - room);
    CHECK(found.deepest_left_out.gap == sorted[room].gap);
    double shallowest = -1;
    for (const Candidate& candidate : found.candidates) shallowest = std::max(shallowest, candidate.gap);
    CHECK(shallowest == sorted[room - 1].gap);
    for (std::size_t i = 1; i < room; ++i) CHECK(found.candidates[i - 1].tool <= found.candidates[i].tool);
  }
}

TEST_CASE("candidates: faulty tools are named and left alone, and go on from where they were") {
  const DeformedBody ear({.levels = 4, .touchable_above = -0.4}, 0.01F);
  SearchBench bench(ear, usual);
  const Shape shape = Shape::sphere(0.004);
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const Pose before = at({0.02, 0, 0}), after = at({-0.02, 0, 0});
  const Pose bad[] = {{{0, nothing, 0}, {1, 0, 0, 0}}, {{}, {0.5, 0.5, 0.5, 0}}, {{1e7, 0, 0}, {1, 0, 0, 0}}};
  const ToolFault fault[] = {ToolFault::not_finite, ToolFault::not_unit, ToolFault::too_far};
  for (int i = 0; i < 3; ++i) {
    bench.search.forget(0);
    bench.find({{shape, before}});
    CHECK(bench.find({{shape, bad[i]}}).candidates.empty());
    CHECK(bench.search.fault(0) == fault[i]);
    CHECK(!bench.find({{shape, after}}).candidates.empty());
    CHECK(bench.search.fault(0) == ToolFault::none);
    CHECK(bench.search.proxy(0, 0).is_held());
  }
  bench.search.forget(0);
  CHECK(bench.find({{shape, after}}).candidates.empty());
  CHECK(bench.find({{Shape::sphere(-1), after}}).candidates.empty());
  CHECK(bench.search.fault(0) == ToolFault::bad_shape);
  SearchBench narrow(ear, {.max_points = 1, .max_candidates = 8});
  CHECK(narrow.find({{Shape::box({1, 1, 1}), after}}).candidates.empty());
  CHECK(narrow.search.fault(0) == ToolFault::too_many_points);
  CHECK(CandidateSearch::required({.max_tools = 0}) == 0);
  CHECK(CandidateSearch::required({.margin = nothing}) == 0);
}

TEST_CASE("candidates: of a displacement that is not finite there are none, and what is held stays on its side") {
  DeformedBody ear({.levels = 4, .touchable_above = -0.4}, 0.01F);
  const Tool before{Shape::sphere(0.004), at({0.02, 0, 0})}, behind{Shape::sphere(0.004), at({-0.02, 0, 0})};
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), HUGE_VALF}) {
    SearchBench bench(ear, usual);
    bench.find({before});
    bench.find({behind});
    std::fill(ear.displacement.begin(), ear.displacement.end(), Vec4{bad, bad, bad, 0});
    ear.update();
    CHECK(bench.find({behind}).candidates.empty());
    std::fill(ear.displacement.begin(), ear.displacement.end(), Vec4{});
    ear.update();
    bench.find({behind});
    CHECK(bench.search.proxy(0, 0).is_held());
    CHECK(bench.search.proxy(0, 0).normal().x > 0.9);
    bench.find({before});
    CHECK(!bench.search.proxy(0, 0).is_held());
  }
}

/// Numbers that every library makes alike.
class Random {
 public:
  std::uint64_t operator()() { return engine_(); }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Double3 vector(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_{41};
};

Pose hostile_pose(const DeformedSurface& surface, Random& random) {
  const auto node = static_cast<std::uint32_t>(random() % surface.node_count());
  const Double3 on = surface.position(node);
  Pose pose;
  double length = 0;  // spinning
  for (double& q : pose.quaternion) q = random.between(-1, 1);
  for (const double q : pose.quaternion) length += q * q;
  for (double& q : pose.quaternion) q /= std::sqrt(length);
  switch (random() % 10) {
    case 0:
      pose.position = random.vector(1e6);
      break;  // teleported
    case 1:
      pose.position = random.vector(0.2);
      break;
    case 2:
      pose.position = on;
      break;  // on a node
    case 3:
      pose.position = surface.position({node % 3, {0.5, 0.5, 0}});
      break;  // on an edge
    case 4:
      pose.position = 0.5 * Double3{0, on.y, on.z};
      break;  // inside
    case 5:
      pose.position = on + random.vector(1e-9);
      break;  // grazing
    case 6:
      pose.position = {0, 0, -0.1};
      break;  // on a fixed node
    case 7:
      pose.position.y = std::numeric_limits<double>::quiet_NaN();
      break;
    case 8:
      pose.quaternion[2] = 3;
      break;  // not of unit length
    default:
      pose.position = on + random.vector(0.01);
      break;
  }
  return pose;
}

void check(const DeformedSurface& surface, const Candidate& candidate) {
  REQUIRE(std::isfinite(candidate.gap));
  REQUIRE(candidate.gap <= 2e-3);
  REQUIRE(std::abs(norm(candidate.normal) - 1) < 1e-9);
  REQUIRE(std::abs(candidate.weight[0] + candidate.weight[1] + candidate.weight[2] - 1) < 1e-9);
  REQUIRE((candidate.triangle != layout::none || surface.is_touchable(candidate.node[0])));
}

void add(const Candidate& candidate, Fnv1a& digest) {
  const Double3 &n = candidate.normal, &x = candidate.position;
  for (const double value : {candidate.gap, n.x, n.y, n.z, x.x, x.y, x.z, candidate.weight[1]}) {
    digest.add_word(std::bit_cast<std::uint64_t>(value));
  }
  digest.add_word(candidate.node[0]);
}

TEST_CASE(
    "candidates: whatever the poses, all numbers are finite, in order, within the work, and everywhere the same") {
  DeformedBody ear({.levels = 4, .touchable_above = -0.4}, 0.01F);
  SearchBench bench(ear, {.max_tools = 5, .max_points = 8, .max_candidates = 24, .margin = 2e-3});
  Random random;
  std::size_t answered = 0;
  Fnv1a digest;
  for (int step = 0; step < 4000; ++step) {
    std::vector<Tool> tools;
    tools.reserve(shapes.size());
    for (const auto& some : shapes) tools.push_back({some.second, hostile_pose(ear.surface, random)});
    if (step % 7 == 0) {
      for (Vec4& u : ear.displacement) u.x = static_cast<float>(random.between(-0.01, 0.01));
      ear.update();
    }
    const auto found = bench.find(tools).candidates;
    answered += found.size();
    for (std::size_t i = 0; i < found.size(); ++i) {
      check(ear.surface, found[i]);
      if (i > 0) REQUIRE(found[i - 1].tool <= found[i].tool);
      add(found[i], digest);
    }
  }
  CHECK(answered > 4000);
  CHECK(digest.value() == 9419400347100004034U);
}

}  // namespace
}  // namespace greenloop
