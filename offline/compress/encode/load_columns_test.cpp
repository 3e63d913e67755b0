#include "offline/compress/encode/load_columns.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::vector<layout::LoadRecord> accelerations() {
  std::vector<layout::LoadRecord> records(3);
  for (std::uint32_t k = 0; k < 3; ++k) records[k].kind = k + 1;
  return records;
}

// smooth, and different along each axis and in each column
MatrixXd fields(Index rows) {
  MatrixXd x(3 * rows, 3);
  for (Index c = 0; c < 3; ++c) {
    for (Index i = 0; i < x.rows(); ++i) {
      x(i, c) = 1e-3 * std::sin(0.01 * static_cast<double>(i) + static_cast<double>(c + i % 3));
    }
  }
  return x;
}

TEST_CASE("columns of loads are the coefficients of the displacements, in the wavelet of the file") {
  const test::Body body = test::make_body<3>(3);
  const MatrixXd given = fields(static_cast<Index>(body.column_nodes.size()));
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(static_cast<int>(kind));
    ModelData model = test::model_of<3>(body, kind, {.threshold = 0.004, .quantum = 0.002});
    add_loads(accelerations(), given, model);
    const test::File file(model);
    REQUIRE(file.view.has_gravity());
    const SurfaceWavelet wavelet(file.view);
    for (std::uint32_t load = 0; load < 3; ++load) {
      std::vector<double> x;
      for (std::uint32_t q = 0; q < file.view.levels; ++q) {
        const float* column = file.view.level[q].load_column(load);
        x.insert(x.end(), column, column + std::size_t{3} * file.view.level[q].counts->domain_count);
      }
      for (std::size_t level = 1; level <= wavelet.finest(); ++level) wavelet.merge(level, 3, x.data());
      REQUIRE(static_cast<Index>(x.size()) == given.rows());
      const Eigen::Map<const Eigen::VectorXd> found(x.data(), given.rows());
      CHECK((found - given.col(load)).cwiseAbs().maxCoeff() < 1e-6 * given.cwiseAbs().maxCoeff());
    }
  }
}

TEST_CASE("columns of loads that are not of the model's domain are refused") {
  const test::Body body = test::make_body<3>(2);
  ModelData model = test::model_of<3>(body, layout::Wavelet::linear, {.threshold = 0.004, .quantum = 0.002});
  CHECK_THROWS_AS(add_loads(accelerations(), MatrixXd::Ones(6, 3), model), std::invalid_argument);
  CHECK_THROWS_AS(add_loads({}, fields(static_cast<Index>(body.column_nodes.size())), model), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
