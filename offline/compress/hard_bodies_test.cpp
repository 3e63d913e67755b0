#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "offline/compress/testing/measured_model.hpp"
#include "offline/compress/testing/solved_body.hpp"

namespace greenloop::offline {
namespace {

bool held_below(const Eigen::Vector3d& x) { return x.z() < -0.7; }

// what every model promises
void check_model(const test::Body& body) {
  const auto model = test::measure_model(body);
  const auto& report = model.built.report;
  CHECK(model.patch_force <= test::default_accuracy.patch_force);
  CHECK(report.levels.back().field_rms_error <= test::default_accuracy.rms);
  CHECK(report.levels.back().field_column_error <= test::default_accuracy.worst_column);
  CHECK(report.lambda_min > 0);
  CHECK(model.certified);
  CHECK(model.definite);
  const double dense = static_cast<double>(report.dense_bytes), bytes = static_cast<double>(report.trials.back().bytes);
  MESSAGE(body.column_nodes.size(), " free nodes, worst patch force ", 100 * model.patch_force, " %, field ",
          100 * report.levels.back().field_rms_error, " % RMS, lambda_min ", report.lambda_min, " m/N, ", dense / bytes,
          " times fewer bytes");
}

double smallest_angle(const SemiRegularMesh& mesh) {
  double smallest = std::numbers::pi;
  for (const auto& t : triangles_of_level(mesh, mesh.finest_level())) {
    for (int k = 0; k < 3; ++k) {
      const auto corner = [&](int c) { return mesh.positions[static_cast<std::size_t>(t[(k + c) % 3])]; };
      const Eigen::Vector3d a = (corner(1) - corner(0)).normalized(), b = (corner(2) - corner(0)).normalized();
      smallest = std::min(smallest, std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
    }
  }
  return smallest * 180 / std::numbers::pi;
}

// some nodes of the finest level moved so far towards a parent that the triangles between them are slivers
SemiRegularMesh slivered(SemiRegularMesh mesh, double left) {
  const std::size_t finest = static_cast<std::size_t>(mesh.finest_level());
  for (std::size_t node = mesh.vertex_end[finest - 1]; node < mesh.positions.size(); node += 8) {
    const Eigen::Vector3d parent = mesh.positions[static_cast<std::size_t>(mesh.parents[node][0])];
    mesh.positions[node] = parent + left * (mesh.positions[node] - parent);
  }
  return mesh;
}

TEST_CASE("a long thin ear is as accurate as asked and positive definite") {
  check_model(test::solve_body(test::eared_ball(3), held_below, {1e5, 0.3}));
}

TEST_CASE("a thin shell, held at one side of its rim, is as accurate as asked and positive definite") {
  check_model(test::solve_body(test::sharp_bowl(3), [](const Eigen::Vector3d& x) { return x.x() < -0.8; }, {1e5, 0.3}));
}

TEST_CASE("a surface with slivers of 3 degrees is built, as accurate as asked") {
  const auto mesh = slivered(test::octasphere(3), 0.05);
  CHECK(smallest_angle(mesh) < 3);
  check_model(test::solve_body(mesh, held_below, {1e5, 0.3}));
}

TEST_CASE("nodes a thousandth of an edge apart are built, as accurate as asked") {
  const auto mesh = slivered(test::octasphere(3), 0.001);
  CHECK(smallest_angle(mesh) < 0.1);
  check_model(test::solve_body(mesh, held_below, {1e5, 0.3}));
}

}  // namespace
}  // namespace greenloop::offline
