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
      CHECK(candidate.motion == Double3{});
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
    CHECK(norm(candidate.motion + moved) < 1e-12);
    if (candidate.triangle != layout::none) continue;
    const double before = norm(candidate.position - Double3{0.149, 0, 0}) - 0.05;
    CHECK(candidate.gap == doctest::Approx(before - dot(moved, candidate.normal)).epsilon(1e-4));
  }
}

TEST_CASE("candidates: every shape that passes the thin ear in one step is stopped on the side that it came from") {
  const DeformedBody ear({.levels = 4, .touchable_above = -0.4}, 0.01F);
  for (const auto& [name, shape] : shapes) {
    CAPTURE(name);
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

// what a step answers, by bits
std::vector<std::uint64_t> bits(const CandidateSearch::Found& found) {
  std::vector<std::uint64_t> all;
  for (const Candidate& candidate : found.candidates) {
    for (const double value : {candidate.gap, candidate.normal.x, candidate.position.y, candidate.weight[1]}) {
      all.push_back(std::bit_cast<std::uint64_t>(value));
    }
    all.push_back(candidate.node[0]);
  }
  return all;
}

TEST_CASE("candidates: whatever the poses, all numbers are finite, in order, within the work, and the same again") {
  DeformedBody ear({.levels = 4, .touchable_above = -0.4}, 0.01F);
  const CandidateSearch::Limits limits{.max_tools = 5, .max_points = 8, .max_candidates = 24, .margin = 2e-3};
  SearchBench bench(ear, limits), again(ear, limits);
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  const auto vector = [&](double size) { return size * Double3{anywhere(random), anywhere(random), anywhere(random)}; };
  const auto pose = [&]() -> Pose {
    const std::uint32_t node = static_cast<std::uint32_t>(random() % ear.surface.node_count());
    const Double3 on = ear.surface.position(node);
    Pose made{{}, {anywhere(random), anywhere(random), anywhere(random), anywhere(random)}};  // spinning
    double length = 0;
    for (const double q : made.quaternion) length += q * q;
    for (double& q : made.quaternion) q /= std::sqrt(length);
    switch (random() % 10) {
      case 0:
        made.position = vector(1e6);
        break;  // teleported
      case 1:
        made.position = vector(0.2);
        break;
      case 2:
        made.position = on;
        break;  // on a node
      case 3:
        made.position = ear.surface.position({node % 3, {0.5, 0.5, 0}});
        break;  // on an edge
      case 4:
        made.position = {0, 0.05 * anywhere(random), 0.05 * anywhere(random)};
        break;  // inside
      case 5:
        made.position = on + vector(1e-9);
        break;  // grazing
      case 6:
        made.position = {0, 0, -0.1};
        break;  // on a fixed node
      case 7:
        made.position.y = nothing;
        break;
      case 8:
        made.quaternion[2] = 3;
        break;
      default:
        made.position = on + vector(0.01);
        break;
    }
    return made;
  };
  std::size_t answered = 0;
  for (int step = 0; step < 4000; ++step) {
    std::vector<Tool> tools;
    for (const auto& [name, shape] : shapes) tools.push_back({shape, pose()});
    if (step % 7 == 0) {
      for (Vec4& u : ear.displacement) u.x = static_cast<float>(0.01 * anywhere(random));
      ear.update();
    }
    const auto found = bench.find(tools);
    REQUIRE(bits(found) == bits(again.find(tools)));
    answered += found.candidates.size();
    for (std::size_t i = 0; i < found.candidates.size(); ++i) {
      const Candidate& candidate = found.candidates[i];
      REQUIRE(std::isfinite(candidate.gap));
      REQUIRE(candidate.gap <= 2e-3);
      REQUIRE(std::abs(norm(candidate.normal) - 1) < 1e-9);
      REQUIRE(std::abs(candidate.weight[0] + candidate.weight[1] + candidate.weight[2] - 1) < 1e-9);
      if (candidate.triangle == layout::none) REQUIRE(ear.surface.is_touchable(candidate.node[0]));
      if (i > 0) REQUIRE(found.candidates[i - 1].tool <= candidate.tool);
    }
  }
  CHECK(answered > 4000);
}

}  // namespace
}  // namespace greenloop
