#include "runtime/finer_surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "runtime/look.hpp"
#include "runtime/testing/split_surface.hpp"

namespace greenloop {
namespace {

using Rule = FinerSurface::Rule;
using Triangles = std::vector<Surface::Triangle>;

// Loop's rule once over any closed triangles, in double, by looking everything up
std::vector<Double3> smoothed(const std::vector<Double3>& x, const Triangles& triangles,
                              std::map<std::pair<std::uint32_t, std::uint32_t>, Double3>& middle) {
  std::vector<Double3> sum(x.size());
  std::vector<int> neighbours(x.size());
  for (const auto& [node] : triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = node[i], b = node[(i + 1) % 3], c = node[(i + 2) % 3];
      sum[a] += x[b];
      ++neighbours[a];
      middle[std::minmax(a, b)] += 0.1875 * (x[a] + x[b]) + 0.125 * x[c];
    }
  }
  std::vector<Double3> moved;
  for (std::size_t v = 0; v < x.size(); ++v) {
    const int n = neighbours[v];
    const double weight = n == 3 ? 3.0 / 16 : 3.0 / (8 * n);
    moved.push_back((1 - n * weight) * x[v] + weight * sum[v]);
  }
  return moved;
}

std::vector<Vec4> random_field(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> any(-0.01F, 0.01F);
  std::vector<Vec4> field(count);
  for (Vec4& u : field) u = {any(random), any(random), any(random), 0};
  return field;
}

double distance(const Vec4& a, const Double3& b) { return norm(exact(a) - b); }

TEST_CASE("levels that are added have four times the triangles, and their vertices halve the edges") {
  const TestModel model({.levels = 3});
  const SplitSurface split(model, 2, {2, Rule::midpoint});
  const auto field = random_field(split.finer.vertex_count(0), 1);
  CHECK(split.finer.vertex_count(0) == split.surface.node_count(2));
  CHECK(split.finer.vertex_count(3) == 0);
  for (std::uint32_t k = 0; k < 2; ++k) {
    CHECK(split.finer.triangle_count(k + 1) == 4 * split.finer.triangle_count(k));
    // Euler's formula of a closed surface without holes
    CHECK(split.finer.triangle_count(k + 1) == 2 * split.finer.vertex_count(k + 1) - 4);
    const auto coarse = split.positions(k, field), fine = split.positions(k + 1, field);
    CHECK(std::equal(coarse.begin(), coarse.end(), fine.begin(),
                     [](const Vec4& a, const Vec4& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }));
    for (std::uint32_t t = 0; t < split.finer.triangle_count(k); ++t) {
      const auto parent = split.finer.triangle(k, t);
      const auto middle = split.finer.triangle(k + 1, 4 * t + 3);
      for (std::uint32_t i = 0; i < 3; ++i) {
        CHECK(split.finer.triangle(k + 1, 4 * t + i).node[i] == parent.node[i]);
        const Double3 ends = exact(coarse[parent.node[i]]) + exact(coarse[parent.node[(i + 1) % 3]]);
        CHECK(distance(fine[middle.node[i]], 0.5 * ends) < 1e-8);
      }
    }
  }
}

TEST_CASE("Loop's rule is that of a plain implementation") {
  const TestModel model({.levels = 3});
  const SplitSurface split(model, 2, {2, Rule::loop});
  const auto field = random_field(split.finer.vertex_count(0), 2);
  std::vector<Double3> x;
  for (const Vec4& at : split.positions(0, field)) x.push_back(exact(at));
  for (std::uint32_t k = 0; k < 2; ++k) {
    Triangles triangles;
    for (std::uint32_t t = 0; t < split.finer.triangle_count(k); ++t) triangles.push_back(split.finer.triangle(k, t));
    std::map<std::pair<std::uint32_t, std::uint32_t>, Double3> middle;
    std::vector<Double3> expected = smoothed(x, triangles, middle);
    const auto found = split.positions(k + 1, field);
    expected.resize(found.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const auto inner = split.finer.triangle(k + 1, 4 * t + 3);
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t a = triangles[t].node[i], b = triangles[t].node[(i + 1) % 3];
        expected[inner.node[i]] = middle.at(std::minmax(a, b));
      }
    }
    double worst = 0;
    for (std::size_t v = 0; v < found.size(); ++v) worst = std::max(worst, distance(found[v], expected[v]));
    CHECK(worst < 1e-7);
    x = expected;
  }
}

TEST_CASE("normals of a finer surface point outwards") {
  const TestModel model({.levels = 3});
  for (const Rule rule : {Rule::midpoint, Rule::loop}) {
    const SplitSurface split(model, 2, {2, rule});
    const auto rest = split.positions(2);
    std::vector<Vec4> normal(rest.size());
    REQUIRE(split.finer.normals(2, rest, normal));
    for (std::size_t v = 0; v < rest.size(); ++v) CHECK(dot(exact(normal[v]), unit(exact(rest[v]))) > 0.9);
  }
}

TEST_CASE("a patch is seen if one of its triangles is") {
  const TestModel model({.levels = 4});
  const SplitSurface split(model, 3, {0, Rule::midpoint});
  const auto field = random_field(split.finer.vertex_count(0), 3);
  std::vector<std::uint8_t> patches(split.surface.triangle_count(1)), each(split.surface.triangle_count(3));
  const Look look{{0, 0, 1}, {0, 0, -1}, 0.99F, 0.02F};
  const Seen found = look_at(split.surface, field, look, patches);
  CHECK(look_at(split.surface, field, look, each).halvings == found.halvings);
  CHECK(found.triangles == std::count(patches.begin(), patches.end(), 1));
  CHECK(found.triangles > patches.size() / 4);
  CHECK(found.triangles < patches.size());
  for (std::size_t patch = 0; patch < patches.size(); ++patch) {
    const auto first = each.begin() + static_cast<std::ptrdiff_t>(16 * patch);
    CHECK(patches[patch] == (std::count(first, first + 16, 1) > 0 ? 1 : 0));
  }
}

TEST_CASE("a look sees what faces it, as finely as it asks") {
  const TestModel model({.levels = 4});
  const SplitSurface split(model, 3, {0, Rule::midpoint});
  const std::uint32_t triangles = split.surface.triangle_count(3);
  std::vector<std::uint8_t> seen(triangles);
  const auto halvings = [&](float detail, float away) {
    return look_at(split.surface, {}, {{0, 0, 0.1F + away}, {0, 0, -1}, -1, detail, 0}, seen).halvings;
  };
  CHECK(halvings(0, 1) == Seen::most_halvings);
  CHECK(halvings(1, 1) == 0);
  for (const float detail : {0.02F, 0.005F}) CHECK(halvings(detail / 2, 1) == halvings(detail, 1) + 1);
  CHECK(halvings(0.002F, 8) + 2 <= halvings(0.002F, 1));
  // half of a ball from afar, each triangle for itself
  const Seen far = look_at(split.surface, {}, {{1e3F, 0, 0}, {-1, 0, 0}, -1, 1, 0}, seen);
  CHECK(far.triangles > 0.45 * triangles);
  CHECK(far.triangles < 0.55 * triangles);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const auto [a, b, c] = split.surface.triangle(3, t).node;
    const auto at = split.positions(0);
    const Double3 normal = cross(exact(at[b]) - exact(at[a]), exact(at[c]) - exact(at[a]));
    if (std::abs(normal.x) > 0.01 * norm(normal)) CHECK(seen[t] == (normal.x > 0 ? 1 : 0));
  }
  CHECK(look_at(split.surface, {}, {{1, 0, 0}, {1, 0, 0}, 0.9F, 1, 0}, seen).triangles == 0);  // turned away
  const float nan = std::nanf("");
  CHECK(look_at(split.surface, {}, {{nan, 0, 0}, {1, 0, 0}, 0.9F, 1, 0}, seen).triangles == 0);
  CHECK(look_at(split.surface, {}, {{1, 0, 0}, {-1, 0, 0}}, {seen.data(), 5}).triangles == 0);
}

// the largest angle between neighbouring triangles of added level k, rad
double largest_angle(const SplitSurface& split, std::uint32_t k) {
  const auto at = split.positions(k);
  std::map<std::pair<std::uint32_t, std::uint32_t>, Double3> first;
  double least = 1;
  for (std::uint32_t t = 0; t < split.finer.triangle_count(k); ++t) {
    const auto [node] = split.finer.triangle(k, t);
    const Double3 normal =
        unit(cross(exact(at[node[1]]) - exact(at[node[0]]), exact(at[node[2]]) - exact(at[node[0]])));
    for (int i = 0; i < 3; ++i) {
      const auto [found, is_new] = first.emplace(std::minmax(node[i], node[(i + 1) % 3]), normal);
      if (!is_new) least = std::min(least, dot(found->second, normal));
    }
  }
  return std::acos(least);
}

TEST_CASE("Loop's rule smooths, and shrinks; midpoints do neither") {
  const TestModel model({.levels = 3});
  double angle[2], farthest[2];
  for (const Rule rule : {Rule::midpoint, Rule::loop}) {
    const SplitSurface split(model, 2, {2, rule});
    angle[static_cast<int>(rule)] = largest_angle(split, 2);
    double worst = 0;
    for (const Vec4& at : split.positions(2)) worst = std::max(worst, 0.1 - norm(exact(at)));
    farthest[static_cast<int>(rule)] = worst;
  }
  const SplitSurface split(model, 2, {0, Rule::midpoint});
  const double before = largest_angle(split, 0);
  MESSAGE("66 nodes of a ball of 100 mm, two levels added: midpoints, angles of ", angle[0], " as before, ",
          1e3 * farthest[0], " mm off; Loop, ", angle[1], " rad, ", 1e3 * farthest[1], " mm");
  CHECK(angle[0] == doctest::Approx(before).epsilon(1e-4));
  CHECK(angle[1] < 0.5 * before);
  CHECK(farthest[1] < 2 * farthest[0]);
}

TEST_CASE("what a finer surface cannot be, or answer, is refused") {
  const TestModel model({.levels = 3});
  const SplitSurface split(model, 2, {1, Rule::loop});
  CHECK(FinerSurface::required(split.surface, {FinerSurface::most_added + 1, Rule::loop}) == 0);
  CHECK(FinerSurface::required(split.surface, {1, static_cast<Rule>(2)}) == 0);
  CHECK(FinerSurface::create(split.surface, {5, Rule::loop}, {}).error == FinerSurface::Error::bad_options);
  const std::size_t need = FinerSurface::required(split.surface, {1, Rule::loop});
  AlignedBytes memory(need + 64);
  const auto small = FinerSurface::create(split.surface, {1, Rule::loop}, {memory.data(), need - 1});
  CHECK(small.error == FinerSurface::Error::memory_too_small);
  CHECK(small.missing == 1);
  CHECK(FinerSurface::create(split.surface, {1, Rule::loop}, {memory.data() + 8, need}).error ==
        FinerSurface::Error::memory_misaligned);
  std::vector<Vec4> position(split.finer.vertex_count(1), Vec4{7, 7, 7, 7});
  CHECK(!split.finer.positions(2, {}, position));
  CHECK(!split.finer.positions(0, {}, position));
  CHECK(!split.finer.positions(1, {position.data(), 3}, position));
  CHECK(!split.finer.normals(1, position, {position.data(), 3}));
  CHECK(std::all_of(position.begin(), position.end(), [](const Vec4& one) { return one.w == 7; }));
}

}  // namespace
}  // namespace greenloop
