// The synthetic model and the dense reference, which the tests of the loop rely on.

#include "formats/testing/synthetic_model.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include "formats/testing/dense_wavelet.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd exact_compliance(const ModelData& model) {
  std::vector<Eigen::Vector3d> domain;
  for (const LevelData& level : model.levels) {
    for (const auto& node : level.nodes) {
      if ((node.flags & layout::node_domain) == 0) continue;
      domain.emplace_back(node.position[0], node.position[1], node.position[2]);
    }
  }
  const auto n = static_cast<Index>(domain.size());
  MatrixXd result(3 * n, 3 * n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) result.block<3, 3>(3 * i, 3 * j) = synthetic_compliance(domain[i], domain[j]);
  }
  return result;
}

double least_eigenvalue(const MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

TEST_CASE("dense wavelet: back undoes forward, on rows and on columns") {
  const ModelData model = synthetic_model({.levels = 3});
  const DenseWavelet wavelet(model);
  const Index n = 3 * wavelet.end(2);
  const MatrixXd before = MatrixXd::Random(n, n);
  MatrixXd x = before;
  wavelet.forward(2, x);
  CHECK((x - before).norm() > 0.1 * before.norm());
  wavelet.forward_columns(2, x);
  wavelet.inverse(2, x);
  wavelet.inverse_columns(2, x);
  CHECK((x - before).norm() <= 1e-14 * before.norm());
}

TEST_CASE("dense wavelet: the lifted details leave the mean of a displacement alone") {
  const ModelData model = synthetic_model({.levels = 3});
  const DenseWavelet wavelet(model);
  // the highest detail: all its neighbours are in the domain
  Index m = 0;
  for (Index i = wavelet.begin(2); i < wavelet.end(2); ++i) {
    const auto height = [&](Index k) { return model.levels[2].nodes[k - wavelet.begin(2)].position[2]; };
    if (m == 0 || height(i) > height(m)) m = i;
  }
  MatrixXd wave = MatrixXd::Zero(3 * wavelet.end(2), 1);
  wave(3 * m) = 1;
  wavelet.inverse(2, wave);
  double mean = 0, size = 0;
  std::uint32_t node = 0;
  for (const LevelData& level : model.levels) {
    for (const auto& record : level.nodes) {
      const Index i = wavelet.domain_index(node++);
      if (i < 0) continue;
      mean += record.area * wave(3 * i);
      size += record.area * std::abs(wave(3 * i));
    }
  }
  CHECK(std::abs(mean) <= 1e-6 * size);
}

TEST_CASE("synthetic model: with all couplings in 16 bits it is the exact compliance to quantisation error") {
  for (const bool lifted : {true, false}) {
    const ModelData model = synthetic_model(
        {.levels = 4, .strong_bits = 16, .medium_bits = 16, .weak_bits = 16, .lifted = lifted, .epsilon = 0});
    const MatrixXd exact = exact_compliance(model);
    const MatrixXd decoded = decoded_compliance(model, 3);
    CHECK((decoded - decoded.transpose()).norm() <= 1e-14 * exact.norm());
    CHECK((decoded - exact).norm() <= 2e-5 * exact.norm());
  }
}

TEST_CASE("synthetic model: positive definite on every level, and as wrong as it says") {
  for (const bool lifted : {true, false}) {
    const ModelData model = synthetic_model({.levels = 3, .lifted = lifted});
    const MatrixXd exact = exact_compliance(model);
    const double exact_least = least_eigenvalue(exact);
    const std::vector<MatrixXd> decoded = decoded_compliances(model);
    for (const MatrixXd& compliance : decoded) CHECK(least_eigenvalue(compliance) > 0.5 * exact_least);
    const double error = (decoded[2] - exact).norm() / exact.norm();
    CHECK(model.levels[2].counts.rms_error == doctest::Approx(error).epsilon(1e-5));
    CHECK(error > 0.002);
    CHECK(error < 0.03);
  }
}

TEST_CASE("synthetic model: the strong couplings alone are coarser, and the field's errors say so") {
  const ModelData both = synthetic_model({.levels = 4});
  const ModelData strong = synthetic_model({.levels = 4, .field_layers = 1});
  const MatrixXd exact = exact_compliance(both);
  const double error = (decoded_compliance(both, 3, 1) - exact).norm() / exact.norm();
  CHECK(both.levels[3].counts.field_rms_error == both.levels[3].counts.rms_error);
  CHECK(strong.levels[3].counts.field_rms_error == doctest::Approx(error).epsilon(1e-5));
  CHECK(strong.levels[3].counts.rms_error == both.levels[3].counts.rms_error);
  CHECK(strong.levels[3].counts.field_column_error > strong.levels[3].counts.worst_column_error);
}

}  // namespace
}  // namespace greenloop
