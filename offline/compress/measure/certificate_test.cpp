#include "offline/compress/measure/certificate.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <utility>

#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

struct Case {
  explicit Case(const ModelData& model)
      : file(model),
        compressed(file.view),
        least(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(test::dense_compliances(file.view).back(),
                                                             Eigen::EigenvaluesOnly)
                  .eigenvalues()
                  .minCoeff()) {}
  test::File file;
  CompressedCompliance<3> compressed;
  double least;  // eigenvalue, m/N
};

const ModelData& model() {
  static const ModelData value =
      test::model_of(test::make_body(2), layout::Wavelet::lifted_linear, {.threshold = 0.004, .quantum = 0.002});
  return value;
}

TEST_CASE("the least eigenvalue is estimated from above, within a few per cent") {
  const Case given(model());
  REQUIRE(given.least > 0);
  double last = 0;
  const double estimate = estimate_least_eigenvalue(given.compressed, [&](double fraction, std::string_view) {
    CHECK(fraction >= last);
    last = fraction;
  });
  CHECK(last == 1.0);
  CHECK(estimate >= given.least * (1 - 1e-6));
  CHECK(estimate <= given.least * 1.05);
  CHECK(estimate_least_eigenvalue(given.compressed, {}) == estimate);
}

TEST_CASE("the check holds below the least eigenvalue and fails above it") {
  const Case given(model());
  const auto below = check_certificate(given.compressed, 0.95 * given.least, {});
  CHECK(below.holds);
  CHECK(below.unknowns == 3 * given.compressed.rows(2));
  CHECK(below.shift > 0.95 * given.least);
  CHECK(below.shift < given.least);
  CHECK_FALSE(check_certificate(given.compressed, 1.05 * given.least, {}).holds);
  CHECK(certificate_check_bytes(given.compressed) == below.unknowns * below.unknowns * 8);
}

TEST_CASE("nothing is certified by a bound that is not positive") {
  const Case given(model());
  CHECK_FALSE(check_certificate(given.compressed, 0.0, {}).holds);
  CHECK_FALSE(check_certificate(given.compressed, -1e-9, {}).holds);
}

TEST_CASE("an indefinite model is found out by both") {
  ModelData disturbed = model();
  for (float& quantum : disturbed.info.quantum) quantum *= 3;
  const Case given(disturbed);
  REQUIRE(given.least < 0);
  CHECK(estimate_least_eigenvalue(given.compressed, {}) <= 0);
  CHECK_FALSE(check_certificate(given.compressed, 1e-12, {}).holds);
}

}  // namespace
}  // namespace greenloop::offline
