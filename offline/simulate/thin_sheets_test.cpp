#include "offline/simulate/thin_sheets.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "offline/simulate/examples/sheets.hpp"
#include "offline/surface/triangle_intersection.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr double door_speed = 0.8;  // 1/s

SheetScene sheet_of(TriangleMesh mesh) {
  SheetScene scene;
  scene.mesh = std::move(mesh);
  scene.fixed.assign(scene.mesh.vertices.size(), 0);
  scene.density = 0.2;
  scene.stretch = 500;
  scene.bend = 3e-4;
  scene.thickness = 3e-3;
  scene.friction = 0;
  scene.settling = 0;
  scene.time_step = 0.02;
  scene.substeps = 12;
  scene.rest = 5e-3;
  return scene;
}

SheetScene cloth_scene(int cells) {
  SheetScene scene = sheet_of(examples::cloth(cells));
  for (std::size_t v = 0; v < scene.fixed.size(); ++v) {
    const Vector3d& p = scene.mesh.vertices[v];
    for (int post = 0; post < 4; ++post) {
      if (std::hypot(p.x() - 0.2 - 0.52 * post / 3, p.y() + 0.2) < 0.014) scene.fixed[v] = 1;
    }
  }
  scene.rigid = {RigidBox{{0, -1.2, -0.04}, {1, 0, 0}}, RigidCylinder{{0.2, -0.2, 0}, {0.2, -0.2, 0.063}, 5e-3}};
  scene.friction = 0.1;
  scene.damping = 4;
  scene.rest = 0.01;
  scene.air = 2;
  scene.settling = 2;
  for (const double turning : {-door_speed, 0.0, door_speed}) scene.impulses.push_back({Vector3d::Zero(), turning});
  return scene;
}

SheetScene plant_scene(int cells) {
  SheetScene scene = sheet_of(examples::plant(cells));
  for (std::size_t v = 0; v < scene.fixed.size(); ++v) scene.fixed[v] = scene.mesh.vertices[v].y() < 0.03 ? 1 : 0;
  scene.density = 0.4;
  scene.stretch = 3000;
  scene.bend = 0.05;
  scene.damping = 3;
  scene.settling = 3;
  for (const double x : {-0.5, 0.0, 0.5}) scene.impulses.push_back({Vector3d(x, 0, 0), 0});
  return scene;
}

TriangleMesh shown(const ThinSheets& sheets) {
  std::vector<float> places(3 * sheets.vertices());
  sheets.positions(places);
  TriangleMesh mesh;
  for (std::size_t i = 0; i < places.size(); i += 3) {
    mesh.vertices.emplace_back(places[i], places[i + 1], places[i + 2]);
  }
  for (std::size_t i = 0; i < sheets.triangles().size(); i += 3) {
    const auto corner = [&](std::size_t k) { return static_cast<int>(sheets.triangles()[i + k]); };
    mesh.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  return mesh;
}

std::size_t crossings(const TriangleMesh& mesh) {
  return self_intersections(mesh, std::vector<bool>(mesh.triangles.size())).size();
}

double largest_move(const TriangleMesh& a, const TriangleMesh& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) most = std::max(most, (a.vertices[v] - b.vertices[v]).norm());
  return most;
}

bool comes_to_rest(ThinSheets& sheets, int frames) {
  for (int frame = 0; frame < frames && !sheets.at_rest(); ++frame) sheets.step();
  return sheets.at_rest();
}

TEST_CASE("cloth on a door: hangs, is swept along, stays out of the door and of itself, comes to rest") {
  const SheetScene scene = cloth_scene(15);
  ThinSheets sheets(scene);
  const TriangleMesh rest = shown(sheets);
  CHECK(sheets.at_rest());
  CHECK(crossings(rest) == 0);
  double moved = 0, deepest = 0;
  std::size_t crossed = 0;
  for (const std::size_t impulse : {2, 1, 0, 1}) {
    sheets.apply(impulse);
    for (int frame = 0; frame < 40; ++frame) {
      sheets.step();
      CHECK((impulse == 1 || !sheets.at_rest()));
      const TriangleMesh now = shown(sheets);
      crossed += crossings(now) > 0 ? 1 : 0;
      moved = std::max(moved, largest_move(now, rest));
      for (const auto& p : now.vertices) {
        for (const auto& shape : scene.rigid) deepest = std::max(deepest, -clearance(shape, p).distance);
      }
    }
  }
  CHECK(moved > 0.05);
  CHECK(moved < 0.5);
  CHECK(deepest == 0);
  CHECK(crossed == 0);
  CHECK(comes_to_rest(sheets, 500));
}

TEST_CASE("leaves in a pot: move, do not cross, come to rest while the pot goes on or stands still") {
  ThinSheets sheets(plant_scene(8));
  const TriangleMesh rest = shown(sheets);
  CHECK(crossings(rest) == 0);
  for (const std::size_t impulse : {2, 1, 0, 1}) {
    sheets.apply(impulse);
    double moved = 0;
    for (int frame = 0; frame < 15; ++frame) {
      sheets.step();
      moved = std::max(moved, largest_move(shown(sheets), rest));
    }
    CHECK(moved > 0.01);
    CHECK(crossings(shown(sheets)) == 0);
    CHECK(comes_to_rest(sheets, 400));
  }
}

/// A strip of unit squares, `long_cells` along x and two across.
TriangleMesh strip(int long_cells, double cell) {
  TriangleMesh mesh;
  for (int i = 0; i <= long_cells; ++i) {
    for (int j = -1; j <= 1; ++j) mesh.vertices.emplace_back(cell * i, 0, cell * j);
  }
  for (int i = 0; i < long_cells; ++i) {
    for (int j = 0; j < 2; ++j) {
      const int a = 3 * i + j, b = a + 1, c = a + 3, d = a + 4;
      if (j == 0) mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
      if (j == 1) mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, d, c}});
    }
  }
  return mesh;
}

TEST_CASE("a strip held at one end sinks as its hinges do") {
  constexpr int cells = 6;
  constexpr double cell = 0.02;  // two rows are held
  SheetScene scene = sheet_of(strip(cells, cell));
  for (int v = 0; v < 6; ++v) scene.fixed[static_cast<std::size_t>(v)] = 1;
  scene.stretch = 5000;
  scene.bend = 5e-3;
  scene.substeps = 100;
  scene.settling = 6;
  const ThinSheets sheets(scene);
  // moments over a hinge's stiffness, times what is beyond; all bend is in a third of the edges, which are three times
  // as stiff for that
  double beam = 0;
  for (int beyond = 1; beyond < cells; ++beyond) {
    beam += scene.density * 9.81 / 2 * std::pow(beyond * cell, 3) * cell / (3 * scene.bend);
  }
  const double sunk = -shown(sheets).vertices.back().y();
  CAPTURE(beam);
  CAPTURE(sunk);
  CHECK(sunk > 0.9 * beam);
  CHECK(sunk < 1.1 * beam);
}

TEST_CASE("the angle of a hinge has a sign, and its gradient is what differences say") {
  const auto bent = [](double angle) {
    return std::array<Vector3d, 4>{
        {{0, 0, 0}, {1.3, 0, 0}, {0.4, 0.8, 0}, {0.9, -0.7 * std::cos(angle), -0.7 * std::sin(angle)}}};
  };
  for (const double angle : {-2.5, -0.3, 0.0, 0.3, 2.5}) {
    CAPTURE(angle);
    const HingeAngle hinge = hinge_angle(bent(angle));
    CHECK(std::abs(hinge.angle) == doctest::Approx(std::abs(angle)));
    CHECK(hinge.angle * hinge_angle(bent(0.3)).angle * angle >= 0);
    constexpr double h = 1e-6;
    Vector3d sum = Vector3d::Zero(), turn = Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      sum += hinge.gradient[i];
      turn += bent(angle)[i].cross(hinge.gradient[i]);
      for (int axis = 0; axis < 3; ++axis) {
        auto less = bent(angle), more = bent(angle);
        less[i][axis] -= h;
        more[i][axis] += h;
        const double slope = (hinge_angle(more).angle - hinge_angle(less).angle) / (2 * h);
        CHECK(hinge.gradient[i][axis] == doctest::Approx(slope).epsilon(1e-6));
      }
    }
    CHECK(sum.norm() < 1e-12);
    CHECK(turn.norm() < 1e-12);
  }
}

TEST_CASE("what falls onto a sheet stays above it") {
  TriangleMesh mesh = strip(6, 0.02);
  const auto below = mesh.vertices.size();
  for (const Vector3d& p : strip(6, 0.02).vertices) mesh.vertices.push_back(p + Vector3d(0.007, 0.05, 0.003));
  for (auto t : strip(6, 0.02).triangles) {
    for (int& corner : t) corner += static_cast<int>(below);
    mesh.triangles.push_back(t);
  }
  SheetScene scene = sheet_of(mesh);
  for (std::size_t v = 0; v < below; ++v) scene.fixed[v] = 1;
  scene.impulses = {{}};
  ThinSheets sheets(scene);
  for (int frame = 0; frame < 25; ++frame) sheets.step();
  const TriangleMesh fallen = shown(sheets);
  // but for the parts that jut out
  CHECK(fallen.vertices[below + 10].y() > 0.8 * scene.thickness);
  CHECK(fallen.vertices[below + 10].y() < 2 * scene.thickness);
  CHECK(crossings(fallen) == 0);
}

TEST_CASE("the same state goes on with the same bits, finer vertices are means of the sheet's") {
  SheetScene scene = cloth_scene(8);
  scene.settling = 0.2;
  scene.finer = 2;
  ThinSheets sheets(scene), other(scene);
  CHECK(sheets.vertices() == 33 * 33);
  CHECK(sheets.triangles().size() == 3 * 16 * scene.mesh.triangles.size());
  const FinerSheet finer = loop_subdivision(scene.mesh, 2);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(finer.weights.cols());
  CHECK((finer.weights * ones - Eigen::VectorXd::Ones(finer.weights.rows())).cwiseAbs().maxCoeff() < 1e-12);
  sheets.apply(2);
  for (int frame = 0; frame < 10; ++frame) sheets.step();
  const auto state = sheets.state();
  for (ThinSheets* from : {&sheets, &other}) {
    from->restore(state);
    CHECK(from->state() == state);
    from->apply(1);
    for (int frame = 0; frame < 10; ++frame) from->step();
  }
  CHECK(sheets.state() == other.state());
  CHECK(!(sheets.state() == state));
  CHECK_THROWS_WITH(sheets.restore(std::span(state).first(7)), doctest::Contains("a state of 7 numbers"));
}

TEST_CASE("clearances of boxes and cylinders, outside, inside and beside their edges") {
  const RigidShape box = RigidBox{{0, 0, 0}, {2, 2, 2}}, bar = RigidCylinder{{0, 0, 0}, {0, 0, 2}, 0.5};
  CHECK(clearance(box, {3, 1, 1}).distance == doctest::Approx(1));
  CHECK(clearance(box, {3, 3, 1}).distance == doctest::Approx(std::sqrt(2)));
  CHECK(clearance(box, {1, 1.8, 1}).distance == doctest::Approx(-0.2));
  CHECK(clearance(box, {1, 1.8, 1}).normal == Vector3d(0, 1, 0));
  CHECK(clearance(bar, {1, 0, 1}).distance == doctest::Approx(0.5));
  CHECK(clearance(bar, {0, 0.4, 1}).distance == doctest::Approx(-0.1));
  CHECK((clearance(bar, {0, 0.4, 1}).normal - Vector3d(0, 1, 0)).norm() < 1e-12);
  CHECK(clearance(bar, {0, 0.8, 2.4}).distance == doctest::Approx(0.5));
}

TEST_CASE("what flies apart is said, with how to mend it") {
  SheetScene scene = cloth_scene(15);
  scene.bend = 1;
  scene.substeps = 1;
  scene.settling = 0;
  ThinSheets sheets(scene);
  sheets.apply(0);
  const auto play = [&] {
    for (int frame = 0; frame < 200; ++frame) sheets.step();
  };
  CHECK_THROWS_WITH(play(), doctest::Contains("raise sheet.substeps"));
}

TEST_CASE("refused: sheets that lack something") {
  SheetScene scene = cloth_scene(6);
  scene.thickness = 0;
  CHECK_THROWS_WITH(ThinSheets{scene}, doctest::Contains("the thickness must be positive"));
  scene.thickness = 1e-3;
  scene.fixed.pop_back();
  CHECK_THROWS_WITH(ThinSheets{scene}, doctest::Contains("one mark of what is fixed"));
}

}  // namespace
}  // namespace greenloop::offline
