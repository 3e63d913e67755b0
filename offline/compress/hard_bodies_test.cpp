#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <stdexcept>

#include "offline/compress/certificate.hpp"
#include "offline/compress/contact_patches.hpp"
#include "offline/compress/dense_reference.hpp"
#include "offline/compress/exact_sample.hpp"
#include "offline/compress/model_builder.hpp"
#include "offline/compress/solved_body.hpp"

namespace greenloop::offline {
namespace {

constexpr Accuracy accuracy{.rms = 0.02, .worst_column = 0.1, .patch_force = 0.05};  // what a scene asks for by itself

bool held_below(const Eigen::Vector3d& x) { return x.z() < -0.7; }

// builds the body's model and checks what every model promises
void check_model(const test::Body& body) {
  const auto built = build_model({body.mesh,
                                  body.flags,
                                  body.area,
                                  body.column_nodes,
                                  test::columns_of(body.compliance),
                                  accuracy,
                                  true,
                                  test::facts(),
                                  "{}",
                                  {}},
                                 {});
  const test::File file(built.model);
  const CompressedCompliance compressed(file.view, layout::layers);

  ContactPatches patches(row_positions(body.mesh, compressed.wavelet(), compressed.finest()),
                         ExactSample::most_patches);
  patches.add(body.compliance, 0);
  const double force_error = patches.worst_force_error(compressed, compressed.finest());
  CHECK(force_error <= accuracy.patch_force);
  CHECK(built.report.field_rms_error <= accuracy.rms);
  CHECK(built.report.field_column_error <= accuracy.worst_column);

  const auto certificate = check_certificate(compressed, file.view.info->lambda_min, {});
  CHECK(certificate.holds);
  const Eigen::MatrixXd dense = test::dense_compliances(file.view, layout::layers).back();
  CHECK(dense.llt().info() == Eigen::Success);
  const auto& finest = built.report.levels.back();
  MESSAGE(body.column_nodes.size() << " free nodes, worst patch force " << 100 * force_error << " %, field "
                                   << 100 * built.report.field_rms_error << " % RMS, lambda_min "
                                   << file.view.info->lambda_min << " m/N, "
                                   << static_cast<double>(finest.dense_blocks) / static_cast<double>(finest.kept_blocks)
                                   << " times fewer blocks");
}

TEST_CASE("a long thin ear") { check_model(test::solve_body(test::eared_ball(3), held_below, {1e5, 0.3})); }

TEST_CASE("a thin shell held at one side of its rim") {
  check_model(test::solve_body(test::bowl(3), [](const Eigen::Vector3d& x) { return x.x() < -0.8; }, {1e5, 0.3}));
}

TEST_CASE("nearly incompressible, nu = 0.45") {
  check_model(test::solve_body(test::icosphere(3), held_below, {1e5, 0.45}));
}

TEST_CASE("nearly incompressible, nu = 0.49") {
  check_model(test::solve_body(test::icosphere(3), held_below, {1e5, 0.49}));
}

TEST_CASE("three fixed nodes: the body rocks on them") {
  const auto mesh = test::icosphere(3);
  std::size_t fixed = 0;
  const auto body = test::solve_body(mesh,
                                     [&](const Eigen::Vector3d& x) {
                                       const bool one =
                                           x == mesh.positions[2] || x == mesh.positions[3] || x == mesh.positions[4];
                                       fixed += one ? 1 : 0;
                                       return one;
                                     },
                                     {1e5, 0.3});
  REQUIRE(fixed == 3);
  check_model(body);
}

}  // namespace
}  // namespace greenloop::offline
