#include "offline/report/mesh_picture.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "offline/report/colour_map.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

/// A unit sphere around the origin by latitude and longitude, held below z = -0.8.
VisibleSurface sphere() {
  constexpr int rings = 24, sectors = 48;
  VisibleSurface surface;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < sectors; ++j) {
      const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * j / sectors;
      surface.positions.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      surface.fixed.push_back(surface.positions.back().z() < -0.8 ? 1 : 0);
    }
  }
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sectors; ++j) {
      const int a = i * sectors + j, b = i * sectors + (j + 1) % sectors;
      surface.triangles.push_back({a, a + sectors, b});
      surface.triangles.push_back({b, a + sectors, b + sectors});
    }
  }
  return surface;
}

/// Pushed inwards around `centre`.
std::vector<Vector3d> dent(const VisibleSurface& surface, const Vector3d& centre) {
  std::vector<Vector3d> displacement;
  for (const Vector3d& position : surface.positions) {
    displacement.emplace_back(-0.1 * std::exp(-(position - centre).squaredNorm() / 0.02) * centre);
  }
  return displacement;
}

int count_like(const Image& image, const Colour& colour, int tolerance) {
  const auto near = [&](std::uint8_t byte, float component) {
    return std::abs(byte - std::lround(255 * component)) <= tolerance;
  };
  return static_cast<int>(std::count_if(image.pixels.begin(), image.pixels.end(), [&](const Pixel& p) {
    return p.alpha == 255 && near(p.red, colour.x()) && near(p.green, colour.y()) && near(p.blue, colour.z());
  }));
}

}  // namespace

TEST_CASE("a view's axes are orthonormal and right-handed, even looking along the upright axis") {
  for (const Vector3d& towards : {Vector3d(1, 2, 3), Vector3d(0, 0, -5), Vector3d(0, 0, 1)}) {
    const ViewFrame frame = view_frame(towards, Vector3d::UnitZ());
    Eigen::Matrix3d axes;
    axes << frame.right, frame.up, frame.towards;
    CHECK((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm() < 1e-12);
    CHECK(axes.determinant() == doctest::Approx(1));
  }
}

TEST_CASE("the camera holds all points, upright, within its margin") {
  const ViewFrame frame = view_frame(Vector3d::UnitX(), Vector3d::UnitZ());
  const Camera camera = fit_camera(frame, {{0, -1, -2}, {5, 1, 2}}, 420, 10);
  CHECK(camera.height == 420);
  CHECK(camera.width == 220);
  const Vector3d low = camera.project({0, -1, -2}), high = camera.project({5, 1, 2});
  CHECK(low.x() == doctest::Approx(10));
  CHECK(low.y() == doctest::Approx(410));
  CHECK(high.x() == doctest::Approx(210));
  CHECK(high.y() == doctest::Approx(10));
  CHECK(high.z() > low.z());
}

TEST_CASE("what is held is below; without supports the longest side stands") {
  VisibleSurface surface = sphere();
  CHECK(upright(surface) == Vector3d::UnitZ());
  for (Vector3d& position : surface.positions) position.z() *= -1;
  CHECK(upright(surface) == -Vector3d::UnitZ());
  std::fill(surface.fixed.begin(), surface.fixed.end(), 0);
  for (Vector3d& position : surface.positions) position.y() *= 3;
  CHECK(upright(surface) == Vector3d::UnitY());
}

TEST_CASE("the chosen view sees the dent wherever it is") {
  const VisibleSurface surface = sphere();
  for (const Vector3d& centre :
       {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, -1, 0), Vector3d(0.48, 0.64, 0.6)}) {
    CAPTURE(centre.transpose());
    const ViewFrame frame = choose_view(surface, dent(surface, centre));
    CHECK(frame.towards.dot(centre) > 0.7);
    CHECK(frame.up.z() > 0);
  }
}

TEST_CASE("a body at rest is seen from where it may be touched") {
  VisibleSurface surface = sphere();
  for (const Vector3d& side : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(-0.8, 0.6, 0)}) {
    CAPTURE(side.transpose());
    surface.touchable.clear();
    for (const Vector3d& position : surface.positions) surface.touchable.push_back(position.dot(side) > 0.5);
    CHECK(choose_view(surface, {}).towards.dot(side) > 0.7);
  }
}

TEST_CASE("exaggeration is round, fills a tenth of the body, and true scale is preferred") {
  CHECK(exaggeration(0, 1) == 1);
  CHECK(exaggeration(0.002, 1) == doctest::Approx(50));
  CHECK(exaggeration(0.012, 1) == doctest::Approx(5));
  CHECK(exaggeration(0.06, 1) == doctest::Approx(1));
  CHECK(exaggeration(0.25, 1) == 1);
  CHECK(exaggeration(1, 1) == doctest::Approx(0.1));
  CHECK(exaggeration(1e-9, 1) == doctest::Approx(1e8));
}

TEST_CASE("the picture shows the body, transparent around it, and dots where it is held") {
  const VisibleSurface surface = sphere();
  const std::vector<Vector3d> rest(surface.positions.size(), Vector3d::Zero());
  const std::vector<float> value(surface.positions.size(), 0.0F);
  const ViewFrame frame = view_frame(Vector3d::UnitX(), Vector3d::UnitZ());
  const Picture picture = deformed_picture(surface, rest, value, frame, 200);
  REQUIRE(picture.image.width == 200);
  CHECK(picture.image.at(0, 0).alpha == 0);
  CHECK(picture.image.at(100, 100).alpha == 255);
  const auto covered = std::count_if(picture.image.pixels.begin(), picture.image.pixels.end(),
                                     [](const Pixel& p) { return p.alpha > 127; });
  CHECK(static_cast<double>(covered) == doctest::Approx(std::numbers::pi * 92 * 92).epsilon(0.02));
  VisibleSurface loose = surface;
  std::fill(loose.fixed.begin(), loose.fixed.end(), 0);
  CHECK_FALSE(deformed_picture(loose, rest, value, frame, 200).image.pixels == picture.image.pixels);
}

TEST_CASE("the outline at rest stands where the body has moved away") {
  VisibleSurface surface = sphere();
  std::fill(surface.fixed.begin(), surface.fixed.end(), 0);
  const std::vector<Vector3d> moved(surface.positions.size(), Vector3d(0, 4, 0));
  const std::vector<float> value(surface.positions.size(), 1.0F);
  const Picture picture =
      deformed_picture(surface, moved, value, view_frame(Vector3d::UnitX(), Vector3d::UnitZ()), 300);
  const Eigen::Vector3d rest = picture.camera.project({0, 0, 0}), now = picture.camera.project({0, 4, 0});
  CHECK(picture.image.at(static_cast<int>(rest.x()), static_cast<int>(rest.y())).alpha == 0);
  CHECK(picture.image.at(static_cast<int>(now.x()), static_cast<int>(now.y())).alpha == 255);
  const Eigen::Vector3d rim = picture.camera.project({0, 0, 1});
  CHECK(picture.image.at(static_cast<int>(rim.x()), static_cast<int>(rim.y()) + 1).alpha > 100);
}

TEST_CASE("a wire picture tints what is touchable") {
  const VisibleSurface surface = sphere();
  const ViewFrame frame = view_frame(Vector3d::UnitX(), Vector3d::UnitZ());
  const std::vector<char> all(surface.positions.size(), 1), none(surface.positions.size(), 0);
  const auto blueness = [&](const std::vector<char>& touchable) {
    const Picture picture = wire_picture(surface, touchable, surface.positions, frame, 200);
    long sum = 0;
    for (const Pixel& p : picture.image.pixels) sum += p.blue - p.red;
    return sum;
  };
  CHECK(blueness(all) > blueness(none) + 100'000);
}

TEST_CASE("the middle of a flat, unmoved face is light and of a displaced one dark") {
  VisibleSurface face{{{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}}, {{0, 1, 2}, {0, 2, 3}}, {0, 0, 0, 0}};
  const ViewFrame frame = view_frame(Vector3d::UnitX(), Vector3d::UnitZ());
  const std::vector<Vector3d> rest(4, Vector3d::Zero());
  const auto green = [&](float value) {
    return deformed_picture(face, rest, std::vector<float>(4, value), frame, 60).image.at(30, 30).green;
  };
  CHECK(green(0) > 190);
  CHECK(green(1) < 60);
  CHECK(count_like(deformed_picture(face, rest, std::vector<float>(4, 0.0F), frame, 60).image, displacement_colour(0),
                   40) > 1000);
}

}  // namespace greenloop::offline
