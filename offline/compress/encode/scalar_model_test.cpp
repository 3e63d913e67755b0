// The whole way of a scalar problem: exact columns, transform, encoding, file, and what the file stands for.

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "formats/verify.hpp"
#include "offline/compress/encode/compressed_compliance.hpp"
#include "offline/compress/encode/coupling_coder.hpp"
#include "offline/compress/encode/model_tables.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/compress/wavelet/equilibrated_prediction.hpp"

namespace greenloop::offline {
namespace {

constexpr double thresholds[] = {0.16, 0.04, 0.01, 0.0025};
constexpr std::size_t patch_nodes = 32;

const test::Body& body() {
  static const test::Body value = test::make_body<1>(4);
  return value;
}

// transformed once, encoded for every threshold
class ScalarModel {
 public:
  explicit ScalarModel(layout::Wavelet kind)
      : wavelet_(make_wavelet<1>(body().mesh, body().flags, body().area, kind, test::columns_of<1>(body().compliance))),
        exact_(transform_compliance<1>(wavelet_, test::columns_of<1>(body().compliance), 5e-4, {})),
        model_(describe_mesh(body().mesh, body().flags, body().area, wavelet_, layout::Problem::scalar,
                             test::facts<1>())) {
    add_representatives(body().mesh, body().flags, model_);
  }

  // the file of a threshold
  [[nodiscard]] test::File file(double threshold) {
    encode_couplings(exact_, {.threshold = threshold, .quantum = 0.5 * threshold}, model_);
    return test::File(model_);
  }

 private:
  SurfaceWavelet wavelet_;
  WaveletCompliance<1> exact_;
  ModelData model_;
};

// the rows nearest to one
std::vector<std::size_t> patch_around(std::size_t centre) {
  const auto& positions = body().mesh.positions;
  const auto& nodes = body().column_nodes;
  std::vector<std::size_t> rows(nodes.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const auto distance = [&](std::size_t row) {
    return (positions[nodes[row]] - positions[nodes[centre]]).squaredNorm();
  };
  std::partial_sort(rows.begin(), rows.begin() + patch_nodes, rows.end(),
                    [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  rows.resize(patch_nodes);
  return rows;
}

struct Errors {
  double rms = 0;    // of all columns
  double patch = 0;  // of the sources that give a patch one value, the worst of all patches
};

Errors errors_of(const ModelView& view) {
  const CompressedCompliance<1> compressed(view);
  const std::size_t finest = compressed.finest(), rows = compressed.rows(finest);
  Eigen::MatrixXd difference = body().compliance;
  for (std::size_t j = 0; j < rows; ++j) {
    const auto column = compressed.column(finest, j);
    difference.col(static_cast<Eigen::Index>(j)) -= Eigen::Map<const Eigen::VectorXd>(column.data(), difference.rows());
  }
  Errors errors{.rms = difference.norm() / body().compliance.norm()};
  const Eigen::VectorXd value = Eigen::VectorXd::Ones(patch_nodes);
  for (std::size_t centre = 0; centre < rows; centre += 37) {
    const auto patch = patch_around(centre);
    const Eigen::VectorXd exact = body().compliance(patch, patch).llt().solve(value);
    const Eigen::VectorXd found = compressed.between(finest, patch).ldlt().solve(value);
    errors.patch = std::max(errors.patch, (found - exact).norm() / exact.norm());
  }
  return errors;
}

// than the dense matrix has
double fewer_numbers(const ModelView& view) {
  const double rows = view.domain_count;
  return rows * rows / (rows + static_cast<double>(block_count(view, 0, layout::layers)));
}

TEST_CASE("a scalar model's errors fall with its threshold, and sources of patches are as near as asked") {
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    ScalarModel model(kind);
    Errors last{.rms = 1, .patch = 1e9};
    for (const double threshold : thresholds) {
      const test::File file = model.file(threshold);
      const Errors errors = errors_of(file.view);
      MESSAGE("threshold ", threshold, ": ", fewer_numbers(file.view), " times fewer numbers, RMS ", errors.rms,
              ", patches ", errors.patch);
      CHECK(errors.rms < last.rms);
      CHECK(errors.patch < last.patch);
      last = errors;
    }
    CHECK(last.rms < 0.01);
    CHECK(last.patch < 0.05);
  }
}

}  // namespace
}  // namespace greenloop::offline
