#include "offline/wrap/wrap.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

#include "offline/surface/surface_preparation.hpp"
#include "offline/surface/test_surfaces.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

/// The surface of a grid of unit cubes: those of 0..size-1 on each axis that `full` names, every vertex once.
TriangleMesh blocks(int size, const std::function<bool(int, int, int)>& full) {
  TriangleMesh mesh;
  const auto vertex = [&](const std::array<int, 3>& at) {
    mesh.vertices.emplace_back(at[0], at[1], at[2]);
    return static_cast<int>(mesh.vertices.size()) - 1;
  };
  const auto is_full = [&](std::array<int, 3> at) {
    return std::all_of(at.begin(), at.end(), [&](int x) { return x >= 0 && x < size; }) && full(at[0], at[1], at[2]);
  };
  for (int i = 0; i < size * size * size; ++i) {
    const std::array<int, 3> at{i % size, i / size % size, i / (size * size)};
    for (int axis = 0; is_full(at) && axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        auto next = at;
        next[axis] += step;
        if (is_full(next)) continue;
        std::array<int, 4> corners{};
        for (int c = 0; c < 4; ++c) {
          auto corner = at;
          corner[axis] += step > 0 ? 1 : 0;
          corner[(axis + 1) % 3] += c == 1 || c == 2 ? 1 : 0;
          corner[(axis + 2) % 3] += c >= 2 ? 1 : 0;
          corners[c] = vertex(corner);
        }
        const auto [a, b, c, d] = corners;
        if (step > 0) {
          mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
        } else {
          mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {a, d, c}});
        }
      }
    }
  }
  return mesh;
}

TriangleMesh solid_block() {
  return blocks(8, [](int, int, int) { return true; });
}

TriangleMesh scaled(TriangleMesh mesh, double factor, const Vector3d& shift = Vector3d::Zero()) {
  for (auto& v : mesh.vertices) v = shift + factor * v;
  return mesh;
}

/// A closed surface as the stages after it want it.
SurfaceReport prepared(const TriangleMesh& mesh) {
  const auto result = prepare_surface(mesh);
  CHECK(result.repairs.empty());
  return result.report;
}

std::string refusal(const TriangleMesh& mesh, const WrapOptions& options = {}) {
  try {
    static_cast<void>(wrap(mesh, options));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

bool tells(const WrapReport& report, const std::string& text) {
  const auto told = describe_wrap(report, "m");
  return std::any_of(told.begin(), told.end(), [&](const auto& s) { return s.find(text) != std::string::npos; });
}

TEST_CASE("a cube is kept with its edges and corners, wherever its faces look") {
  TriangleMesh mesh = cube();
  for (const std::size_t turned : {0, 3, 7}) std::swap(mesh.triangles[turned][0], mesh.triangles[turned][1]);
  const auto [wrapped, report] = wrap(mesh);
  const auto found = prepared(wrapped);
  CHECK(found.volume == doctest::Approx(1).epsilon(1e-6));
  CHECK(found.genus() == 0);
  CHECK(report.from_original.greatest < 1e-6);
  CHECK(report.to_original.greatest < 1e-6);
  CHECK(report.length == 1.0 / 64);
  CHECK(report.misoriented_edges > 0);
  CHECK(!report.volume_before);
  CHECK(tells(report, "faces look to different sides"));
}

TEST_CASE("a block with a hole keeps its concave edges, too") {
  const auto mesh = blocks(8, [](int x, int y, int) { return x < 2 || x > 4 || y < 3 || y > 5; });
  const auto [wrapped, report] = wrap(mesh);
  const auto found = prepared(wrapped);
  CHECK(found.genus() == 1);
  CHECK(found.volume == doctest::Approx(8 * (64 - 9)).epsilon(1e-6));
  CHECK(report.from_original.greatest < 1e-5);
  CHECK(report.to_original.greatest < 1e-5);
  CHECK(report.held_back == 0);
}

TEST_CASE("faces with vertices of their own, a millionth apart, are closed") {
  TriangleMesh mesh = soup(solid_block());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    mesh.vertices[v] += 1e-6 * Vector3d(static_cast<double>(v % 3), static_cast<double>(v % 5), v % 2 ? 1.0 : -1.0);
  }
  const auto [wrapped, report] = wrap(mesh);
  CHECK(prepared(wrapped).volume == doctest::Approx(512).epsilon(1e-4));
  CHECK(report.to_original.greatest < 1e-4);
}

TEST_CASE("a hole is closed flat") {
  TriangleMesh mesh = solid_block();
  const auto middle = [&](const std::array<int, 3>& t) -> Vector3d {
    return (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
  };
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const Vector3d at = middle(t);
    return at.z() == 8 && at.x() > 3 && at.x() < 5 && at.y() > 3 && at.y() < 5;
  });
  const auto [wrapped, report] = wrap(mesh);
  const auto found = prepared(wrapped);
  CHECK(found.genus() == 0);
  CHECK(found.volume == doctest::Approx(512).epsilon(1e-3));
  CHECK(found.box.max().z() < 8 + report.length);
  CHECK(report.boundary_loops > 0);
  CHECK(tells(report, "closed"));
}

TEST_CASE("a bottle stays open, though its neck is narrow") {
  const auto bottle = blocks(8, [](int x, int y, int z) {
    const bool hollow = x > 0 && x < 7 && y > 0 && y < 7 && z > 0 && z < 7;
    const bool neck = (x == 3 || x == 4) && (y == 3 || y == 4) && z == 7;
    return !hollow && !neck;
  });
  const auto [wrapped, report] = wrap(bottle);
  CHECK(prepared(wrapped).volume == doctest::Approx(512 - 216 - 4).epsilon(1e-3));
}

TEST_CASE("bodies that cross become one") {
  const auto [wrapped, report] = wrap(joined(cube(), cube({0.5, 0.5, 0.5})));
  const auto found = prepared(wrapped);
  CHECK(found.component_sizes.size() == 1);
  CHECK(found.volume == doctest::Approx(2 - 0.125).epsilon(1e-3));
  CHECK(report.inner_share == doctest::Approx(0.125).epsilon(0.2));
  CHECK(report.volume_before == doctest::Approx(2));
  CHECK(tells(report, "lies inside the body"));
  CHECK(tells(report, "faces cross"));
}

TEST_CASE("an inner shell is filled, and said to be") {
  const auto [wrapped, report] = wrap(joined(cube(), scaled(cube(), 0.5, {0.25, 0.25, 0.25})));
  CHECK(prepared(wrapped).volume == doctest::Approx(1).epsilon(1e-6));
  CHECK(report.filled_shells == 1);
  CHECK(tells(report, "1 inner shell filled"));
}

TEST_CASE("crumbs are dropped; several bodies are refused, unless the largest one is asked for") {
  const auto crumb = wrap(joined(cube(), scaled(cube(), 0.1, {1.1, 0, 0})));
  CHECK(crumb.report.pieces_dropped == 1);
  CHECK(prepared(crumb.mesh).volume == doctest::Approx(1).epsilon(1e-6));

  const auto two = joined(cube(), scaled(cube(), 0.5, {1.1, 0, 0}));
  CHECK(refusal(two).find("2 separate pieces") != std::string::npos);
  CHECK(refusal(two).find("pieces = \"largest\"") != std::string::npos);
  const auto largest = wrap(two, {.length = {}, .largest_piece = true});
  CHECK(prepared(largest.mesh).volume == doctest::Approx(1).epsilon(1e-6));
  CHECK(largest.report.dropped_share == doctest::Approx(1.0 / 9).epsilon(0.05));
}

TEST_CASE("an open sheet becomes a plate") {
  const TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto [wrapped, report] = wrap(sheet, {.length = 0.05, .largest_piece = false});
  REQUIRE(report.plate_thickness);
  CHECK(*report.plate_thickness == doctest::Approx(0.15));
  const auto found = prepared(wrapped);
  CHECK(found.box.sizes().z() == doctest::Approx(0.15).epsilon(0.02));
  CHECK(tells(report, "an open sheet (100 % of its area has nothing behind it) made a plate 0.15 m thick"));
}

TEST_CASE("a face that sticks out of a body is dropped") {
  const TriangleMesh fin{{{0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}, {0.5, 0.4, 1.5}}, {{0, 1, 2}}};
  const auto [wrapped, report] = wrap(joined(cube(), fin));
  CHECK(prepared(wrapped).volume == doctest::Approx(1).epsilon(1e-3));
  CHECK(!report.plate_thickness);
  CHECK(report.sheet_share > 0.01);
  CHECK(tells(report, "has nothing behind it and was dropped"));
}

TEST_CASE("faces without an area, doubled faces, needles and a vertex in an edge do not disturb") {
  TriangleMesh mesh = cube();
  mesh.vertices.emplace_back(0.5, 0, 0);     // in the middle of an edge of one face only
  mesh.vertices.emplace_back(0.3, 0.3, 0);   // of a face of its own that is a line
  mesh.vertices.emplace_back(0.5, 1e-7, 0);  // of a needle
  mesh.triangles.push_back({0, 3, 9});
  mesh.triangles.push_back({0, 10, 1});
  mesh.triangles.push_back(mesh.triangles[2]);
  mesh.triangles[4] = {0, 8, 5};
  mesh.triangles.push_back({8, 1, 5});
  const auto [wrapped, report] = wrap(mesh);
  CHECK(prepared(wrapped).volume == doctest::Approx(1).epsilon(1e-6));
  CHECK(report.useless_faces == 2);
}

/// A box from the origin.
TriangleMesh box(const Vector3d& sides) {
  auto mesh = cube();
  for (auto& v : mesh.vertices) v = v.cwiseProduct(sides);
  return mesh;
}

TEST_CASE("rounding leaves what is thick where it is, but for edges") {
  const auto [wrapped, report] = wrap(cube(), {.length = 0.03, .rounding = 0.1});
  const auto found = prepared(wrapped);
  CHECK(report.rounding == 0.1);
  for (int axis = 0; axis < 3; ++axis) CHECK(found.box.sizes()[axis] == doctest::Approx(1).epsilon(0.03));
  CHECK(found.volume < 1);
  CHECK(found.volume > 0.95);
  CHECK(report.from_original.greatest < 0.1);
  CHECK(tells(report, "rounded"));
}

TEST_CASE("rounding thickens a needle and a sheet, thinner than the lattice tells, too") {
  const auto needle = prepared(wrap(box({1, 0.02, 0.02}), {.length = 0.02, .rounding = 0.08}).mesh);
  CHECK(needle.box.sizes().y() == doctest::Approx(0.16).epsilon(0.25));
  CHECK(needle.box.sizes().x() < 1.2);

  const auto sheet = box({1, 1, 0.004});
  CHECK_THROWS_AS(static_cast<void>(wrap(sheet, {.length = 0.04})), NothingLeft);
  const auto plate = prepared(wrap(sheet, {.length = 0.04, .rounding = 0.1}).mesh);
  CHECK(plate.genus() == 0);
  CHECK(plate.box.sizes().z() == doctest::Approx(0.2).epsilon(0.25));
}

TEST_CASE("rounding closes a gap") {
  const auto slit = blocks(8, [](int x, int, int z) { return z == 0 || x != 4; });
  CHECK(prepared(wrap(slit, {.length = 0.25}).mesh).volume == doctest::Approx(512 - 56).epsilon(0.01));
  const double rounded = prepared(wrap(solid_block(), {.length = 0.25, .rounding = 1}).mesh).volume;
  CHECK(prepared(wrap(slit, {.length = 0.25, .rounding = 1}).mesh).volume == doctest::Approx(rounded).epsilon(0.02));
}

TEST_CASE("the same faces give the same bits") {
  const auto mesh = joined(cube(), cube({0.5, 0.4, 0.3}));
  const auto first = wrap(mesh).mesh, second = wrap(mesh).mesh;
  CHECK(first.vertices == second.vertices);
  CHECK(first.triangles == second.triangles);
}

TEST_CASE("refused: lengths that are too short, with the least that will do, or too long, and faces without an area") {
  const std::string too_short = refusal(cube(), {.length = 1e-3, .largest_piece = false});
  CHECK(too_short.find("a length of 0.001 takes a lattice of 1.03e+09 points; there may be 16777216") !=
        std::string::npos);
  const double least = std::stod(too_short.substr(too_short.find("which a length of ") + 18));
  CHECK(refusal(cube(), {.length = least * 1.01, .largest_piece = false}).empty());
  CHECK(refusal(cube(), {.length = 0.2, .largest_piece = false}).find("it may be 0.125, an eighth of that, at most") !=
        std::string::npos);
  CHECK(refusal({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}).find("no face has an area") != std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
