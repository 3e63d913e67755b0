// The synthetic model and the dense reference, which the tests of the loop rely on.

#include "formats/testing/synthetic_model.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cstdlib>

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
  const Index components = model.info.components;
  MatrixXd result(components * n, components * n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      if (components == 1) {
        result(i, j) = synthetic_scalar_compliance(domain[i], domain[j]);
      } else {
        result.block<3, 3>(3 * i, 3 * j) = synthetic_compliance(domain[i], domain[j]);
      }
    }
  }
  return result;
}

constexpr std::uint32_t all_components[] = {1, 3};

double least_eigenvalue(const MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

TEST_CASE("dense wavelet: back undoes forward, on rows and on columns") {
  for (const std::uint32_t components : all_components) {
    const DenseWavelet wavelet(synthetic_model({.components = components, .levels = 3}));
    const Index n = wavelet.rows(2);
    CHECK(n == components * wavelet.end(2));
    const MatrixXd before = MatrixXd::Random(n, n);
    MatrixXd x = before;
    wavelet.forward(2, x);
    CHECK((x - before).norm() > 0.1 * before.norm());
    wavelet.forward_columns(2, x);
    wavelet.inverse(2, x);
    wavelet.inverse_columns(2, x);
    CHECK((x - before).norm() <= 1e-14 * before.norm());
  }
}

TEST_CASE("dense wavelet: without block weights a scalar is transformed as one component of a vector is") {
  const ModelData scalar = synthetic_model({.components = 1, .levels = 3});
  const DenseWavelet of_scalars(scalar), of_vectors(synthetic_model({.levels = 3}));
  const Index n = of_scalars.rows(2);
  const MatrixXd before = MatrixXd::Random(n, 2);
  MatrixXd x = before, y = MatrixXd::Zero(3 * n, 2);
  for (Index i = 0; i < n; ++i) y.row(3 * i + 1) = before.row(i);
  of_scalars.forward(2, x);
  of_vectors.forward(2, y);
  for (Index i = 0; i < n; ++i) CHECK(y.row(3 * i + 1) == x.row(i));
}

TEST_CASE("dense wavelet: the lifted details leave the mean of a displacement alone") {
  layout::Wavelet kind{};
  SUBCASE("linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("butterfly") { kind = layout::Wavelet::lifted_butterfly; }
  const ModelData model = synthetic_model({.levels = 3, .wavelet = kind});
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

TEST_CASE("synthetic model: the wavelet form of its compliance, restored, is the compliance between averages") {
  for (const std::uint32_t components : all_components) {
    const ModelData model = synthetic_model({.components = components, .levels = 3});
    const DenseWavelet wavelet(model);
    const MatrixXd exact = exact_compliance(model);
    MatrixXd form = exact;
    to_wavelet_form(wavelet, form);
    MatrixXd averages = exact;
    wavelet.forward(2, averages);
    wavelet.forward_columns(2, averages);
    MatrixXd coarse = form.topLeftCorner(wavelet.rows(1), wavelet.rows(1));
    from_wavelet_form(wavelet, 1, coarse);
    CHECK((coarse - averages.topLeftCorner(coarse.rows(), coarse.cols())).norm() <= 1e-14 * exact.norm());
    from_wavelet_form(wavelet, 2, form);
    CHECK((form - exact).norm() <= 1e-14 * exact.norm());
  }
}

// Every scaled value of a model with all couplings in 16 bits is right to half a quantum, and some are wrong by `least`
// quanta.
template <unsigned N>
void check_rounding(layout::Wavelet kind, double least) {
  const ModelData model =
      synthetic_model({.components = N, .levels = 4, .wavelet = kind, .epsilon = 0, .quantum = 1e-12});
  std::vector<Eigen::Matrix<double, N, N>> inverse;
  for (const LevelData& level : model.levels) {
    for (const auto& scale : level.scales.of<N>()) inverse.emplace_back(symmetric_matrix(scale.root).inverse());
    for (std::uint32_t layer = 2; layer < layout::layers; ++layer) {
      // only what is exactly 0, as a scalar may be
      const auto& values = level.couplings[layer].value;
      CHECK((N == 1 || values.empty()));
      CHECK(std::all_of(values.begin(), values.end(), [](int value) { return value == 0; }));
    }
  }
  const DenseWavelet wavelet(model);
  const MatrixXd decoded = decoded_compliance(model, 3);
  CHECK((decoded - decoded.transpose()).norm() <= 1e-14 * decoded.norm());
  MatrixXd error = decoded - exact_compliance(model);
  to_wavelet_form(wavelet, error);
  double of_couplings = 0, of_diagonals = 0;
  for (Index i = 0; i < wavelet.end(3); ++i) {
    for (Index j = 0; j < wavelet.end(3); ++j) {
      double& worst = i == j ? of_diagonals : of_couplings;
      worst = std::max(worst, (inverse[i] * error.block<N, N>(N * i, N * j) * inverse[j]).cwiseAbs().maxCoeff());
    }
  }
  // positions are rounded to float in the model, which adds 1 percent
  CHECK(of_couplings <= 0.51 * double{model.info.quantum[0]});
  CHECK(of_couplings >= least * double{model.info.quantum[0]});
  CHECK(of_diagonals <= 1e-6);
}

TEST_CASE("synthetic model: with all couplings in 16 bits every scaled value is right to half a quantum") {
  for (const layout::Wavelet kind : layout::wavelets) {
    check_rounding<1>(kind, 0.45);  // of fewer values
    check_rounding<3>(kind, 0.49);
  }
}

void check_positive_definite(const ModelData& model) {
  const MatrixXd exact = exact_compliance(model);
  const double exact_least = least_eigenvalue(exact);
  for (std::uint32_t q = 0; q < 3; ++q) {
    CHECK(least_eigenvalue(decoded_compliance(model, q)) > 0.5 * exact_least);
  }
  const double error = (decoded_compliance(model, 2) - exact).norm() / exact.norm();
  CHECK(model.levels[2].counts.rms_error == doctest::Approx(error).epsilon(1e-5));
  CHECK(error > 0.002);
  CHECK(error < 0.03);
}

TEST_CASE("synthetic model: positive definite on every level, and as wrong as it says") {
  for (const layout::Wavelet kind : layout::wavelets) {
    for (const std::uint32_t components : all_components) {
      CAPTURE(components);
      check_positive_definite(
          synthetic_model({.components = components, .levels = 3, .wavelet = kind, .epsilon = 0.008}));
    }
  }
}

void check_layers(const ModelData& model) {
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    CAPTURE(layer);
    const CouplingsData& data = model.levels[3].couplings[layer];
    CHECK(data.index.size() > 10);
    const int largest = std::abs(*std::max_element(data.value.begin(), data.value.end(),
                                                   [](int a, int b) { return std::abs(a) < std::abs(b); }));
    const int most = (1 << (layout::value_bits[layer] - 1)) - 1;
    CHECK(largest <= most);
    CHECK(largest > most / 16);
    for (std::uint32_t other = 0; other < layer; ++other) {
      CHECK(model.info.quantum[layer] != model.info.quantum[other]);
    }
  }
}

TEST_CASE("synthetic model: every layer holds couplings, each of another quantum, and uses its bits") {
  for (const layout::Wavelet kind : layout::wavelets) {
    for (const std::uint32_t components : all_components) {
      CAPTURE(components);
      check_layers(synthetic_model({.components = components, .levels = 4, .wavelet = kind}));
    }
  }
}

}  // namespace
}  // namespace greenloop
