// Surfaces as drawing programs make them: faces in needles, meeting in edges and corners.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/feature_curves.hpp"
#include "offline/remesh/remesh.hpp"
#include "offline/remesh/test_drawings.hpp"

namespace greenloop::offline {
namespace {

using Vertices = std::vector<Eigen::Vector3d>;

/// An L of unit arms, its faces split to `parts` along each unit, so that it is no base by itself.
TriangleMesh l_shape(int parts) {
  TriangleMesh mesh;
  const auto solid = [&](int x, int y, int z) {
    return z >= 0 && z < parts && x >= 0 && y >= 0 && x < 2 * parts && y < 2 * parts && (x < parts || y < parts);
  };
  const auto vertex = [&](const Eigen::Vector3i& p) {
    const Eigen::Vector3d place = p.cast<double>() / parts;
    const auto found = std::find(mesh.vertices.begin(), mesh.vertices.end(), place);
    if (found != mesh.vertices.end()) return static_cast<int>(found - mesh.vertices.begin());
    mesh.vertices.push_back(place);
    return static_cast<int>(mesh.vertices.size()) - 1;
  };
  for (int x = 0; x < 2 * parts; ++x) {
    for (int y = 0; y < 2 * parts; ++y) {
      for (int z = 0; z < parts; ++z) {
        if (!solid(x, y, z)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int side : {0, 1}) {
            Eigen::Vector3i beyond(x, y, z), u = Eigen::Vector3i::Zero(), v = Eigen::Vector3i::Zero();
            beyond[axis] += side == 1 ? 1 : -1;
            if (solid(beyond.x(), beyond.y(), beyond.z())) continue;
            Eigen::Vector3i origin(x, y, z);
            origin[axis] += side;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
            if (side == 0) std::swap(u, v);
            const int a = vertex(origin), b = vertex(origin + u), c = vertex(origin + u + v), d = vertex(origin + v);
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          }
        }
      }
    }
  }
  return mesh;
}

double nearest(const Vertices& vertices, const Eigen::Vector3d& place) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& v : vertices) least = std::min(least, (v - place).norm());
  return least;
}

void check_accepted(const Remeshed& remeshed) {
  CHECK(remeshed.quality.flipped == 0);
  CHECK(remeshed.quality.self_intersections == 0);
  CHECK(remeshed.quality.smallest_angle_degrees >= 8);
}

}  // namespace

TEST_CASE("the lines of a box with a hole are found, its needles and facets are none") {
  const auto mesh = box_with_hole({40, 30, 10}, 12, 32);
  const auto features = find_features(mesh, 40, 1);
  CHECK(features.corner_count() == 8);
  CHECK(features.chains.size() == 14);  // twelve edges and two rims
  CHECK(std::count_if(features.chains.begin(), features.chains.end(), [](const auto& c) { return c.loop; }) == 2);
  CHECK(find_features(mesh, 95, 1).chains.empty());
}

TEST_CASE("short loose lines and loops are noise") {
  const auto mesh = box_with_hole({40, 30, 10}, 1, 32);  // rims 6.3 long
  CHECK(find_features(mesh, 40, 7).chains.size() == 12);
  CHECK(find_features(mesh, 40, 6).chains.size() == 14);
}

TEST_CASE("a box with a hole keeps its corners, edges and rims") {
  const auto mesh = box_with_hole({40, 30, 10}, 12, 32);
  const auto remeshed = remesh(mesh, {});
  check_accepted(remeshed);
  CHECK(remeshed.quality.base_vertices <= 60);
  CHECK(remeshed.quality.hausdorff < 0.25);  // of a box 80 long: the hole's facets
  CHECK(std::abs(remeshed.quality.volume_change) < 0.002);
  for (std::size_t v = 64; v < mesh.vertices.size(); ++v) {
    CHECK(nearest(remeshed.mesh.positions, mesh.vertices[v]) < 1e-12);  // its corners, to rounding
  }
  int on_rim = 0;
  for (const auto& p : remeshed.mesh.positions) {
    const double apothem = 12 * std::cos(std::numbers::pi / 32);
    if (std::abs(p.z() - 10) < 1e-9 && p.head<2>().norm() < 12 + 1e-9) {
      CHECK(p.head<2>().norm() > apothem - 1e-9);
      ++on_rim;
    }
  }
  CHECK(on_rim >= 3 * 8);
}

TEST_CASE("needles to rims of many sides are no hindrance") {
  const auto remeshed = remesh(box_with_hole({40, 30, 3}, 5, 96), {});
  check_accepted(remeshed);
  CHECK(remeshed.quality.hausdorff < 0.25);
}

TEST_CASE("an L keeps its edges") {
  const auto mesh = l_shape(4);
  const auto remeshed = remesh(mesh, {});
  check_accepted(remeshed);
  CHECK(remeshed.quality.hausdorff < 1e-9);  // flat faces between straight edges: nothing is lost
  CHECK(std::abs(remeshed.quality.volume_change) < 1e-9);
}

TEST_CASE("an angle too narrow is widened, so that edges need no larger base") {
  const auto remeshed = remesh(box_with_hole({40, 30, 3}, 28, 48), {});
  check_accepted(remeshed);
  MESSAGE(remeshed.quality.base_vertices << " base vertices, " << remeshed.quality.smallest_angle_degrees
                                         << " degrees");
}

TEST_CASE("the work of a search in vain is bounded, and the next base to try is one that was not") {
  RemeshOptions options;
  options.base_vertices = 24;
  options.smallest_angle = 59;
  std::vector<std::string> attempts;
  std::string message;
  try {
    (void)remesh(box_with_hole({40, 30, 10}, 12, 32), options, [&](double, std::string_view stage) {
      if (stage.starts_with("sliding") && (attempts.empty() || attempts.back() != stage)) attempts.emplace_back(stage);
    });
    FAIL("triangles all but equilateral");
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  int finest = 0, largest = 0;
  for (const auto& stage : attempts) {
    const int base = std::stoi(stage.substr(std::string("sliding ").size()));
    finest += 64 * base;
    largest = std::max(largest, base);
  }
  CHECK(attempts.size() >= 2);
  // Seven at most are over the few triangles of the input, the others over a ground of about 10,000 vertices, each of
  // which counts as a quarter of a vertex moved in all 60 sweeps.
  const int over_many = std::max(0, static_cast<int>(attempts.size()) - 7);
  CHECK(finest + 2000 * over_many <= 9 * (64 * 24 + 2500));
  CHECK(message.find("the next that was not tried is " + std::to_string(std::lround(1.4 * largest))) !=
        std::string::npos);
}

}  // namespace greenloop::offline
