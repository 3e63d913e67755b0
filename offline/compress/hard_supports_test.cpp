#include <doctest/doctest.h>

#include <initializer_list>
#include <stdexcept>

#include "offline/compress/testing/measured_model.hpp"
#include "offline/compress/testing/solved_body.hpp"

namespace greenloop::offline {
namespace {

// what every model promises
void check_model(const test::Body& body) {
  const auto model = test::measure_model(body);
  CHECK(model.patch_force <= test::default_accuracy.patch_force);
  CHECK(model.built.report.levels.back().field_rms_error <= test::default_accuracy.rms);
  CHECK(model.built.report.lambda_min > 0);
  CHECK(model.certified);
  CHECK(model.definite);
  MESSAGE(body.column_nodes.size(), " free nodes, worst patch force ", 100 * model.patch_force, " %, field ",
          100 * model.built.report.levels.back().field_rms_error, " % RMS, lambda_min ", model.built.report.lambda_min,
          " m/N");
}

// a ball that is fixed at some nodes of its base mesh only
test::Body held_at(std::initializer_list<std::size_t> nodes) {
  const auto mesh = test::octasphere(3);
  return test::solve_body(mesh,
                          [&](const Eigen::Vector3d& x) {
                            for (const std::size_t node : nodes) {
                              if (x == mesh.positions[node]) return true;
                            }
                            return false;
                          },
                          {1e5, 0.3});
}

TEST_CASE("three fixed nodes hold a body, which is as accurate in force as one on a broad support") {
  const auto body = held_at({0, 3, 5});
  CHECK(body.column_nodes.size() + 3 == body.mesh.positions.size());
  check_model(body);
}

TEST_CASE("one or two fixed nodes do not hold a body: refused with the remedy") {
  CHECK_THROWS_WITH_AS((void)held_at({5}), doctest::Contains("can move rigidly"), std::runtime_error);
  CHECK_THROWS_WITH_AS((void)held_at({0, 3}), doctest::Contains("fix more of it"), std::runtime_error);
}

TEST_CASE("nearly incompressible bodies are as accurate in force as others") {
  for (const double poisson : {0.45, 0.49}) {
    CAPTURE(poisson);
    check_model(
        test::solve_body(test::octasphere(3), [](const Eigen::Vector3d& x) { return x.z() < -0.7; }, {1e5, poisson}));
  }
}

}  // namespace
}  // namespace greenloop::offline
