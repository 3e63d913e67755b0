#include "offline/compress/measure/contact_patches.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

struct Case {
  test::Body body = test::make_body(3);
  test::File file{test::model_of(body, layout::Wavelet::lifted_linear, {.threshold = 0.004, .quantum = 0.002})};
  CompressedCompliance<3> compressed{file.view};
  std::vector<Eigen::MatrixXd> dense = test::dense_compliances(file.view);  // what the file stands for
};

const Case& given() {
  static const Case value;
  return value;
}

std::vector<Eigen::Vector3d> positions(std::size_t level) {
  const auto& body = given().body;
  std::vector<Eigen::Vector3d> result;
  result.reserve(given().compressed.rows(level));
  for (std::size_t row = 0; row < given().compressed.rows(level); ++row) {
    result.push_back(body.mesh.positions[body.column_nodes[row]]);
  }
  return result;
}

// in pieces, as columns stream by
ContactPatches patches_of(const Eigen::MatrixXd& exact, std::size_t level, std::size_t count) {
  ContactPatches patches(positions(level), count);
  const auto rows = static_cast<std::size_t>(exact.rows()) / 3;
  for (std::size_t first = 0; first < rows; first += 50) {
    patches.add(test::columns_of(exact)(first, std::min<std::size_t>(50, rows - first)), first);
  }
  return patches;
}

// the patch around `centre`, by the definition
double dense_error(const Eigen::MatrixXd& exact, const Eigen::MatrixXd& found, std::size_t level, std::size_t centre) {
  const auto at = positions(level);
  std::vector<std::size_t> rows(at.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return (at[a] - at[centre]).squaredNorm() < (at[b] - at[centre]).squaredNorm();
  });
  rows.resize(std::min<std::size_t>(rows.size(), 64));
  std::vector<Eigen::Index> unknowns;
  for (const std::size_t row : rows) {
    for (std::size_t k = 0; k < 3; ++k) unknowns.push_back(static_cast<Eigen::Index>(3 * row + k));
  }
  const Eigen::MatrixXd held = Eigen::Matrix3d::Identity().replicate(static_cast<Eigen::Index>(rows.size()), 1);
  const Eigen::MatrixXd a = exact(unknowns, unknowns).partialPivLu().solve(held);
  const Eigen::MatrixXd b = found(unknowns, unknowns).partialPivLu().solve(held);
  double worst = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    worst = std::max(worst, (b.col(axis) - a.col(axis)).norm() / a.col(axis).norm());
  }
  return worst;
}

TEST_CASE("a compressed model has no force error against itself") {
  for (std::size_t level = 0; level < 4; ++level) {
    CAPTURE(level);
    const auto patches = patches_of(given().dense[level], level, 10);
    CHECK(patches.worst_force_error(given().compressed, level) < 1e-4);
  }
}

TEST_CASE("against the exact compliance the error is that of a dense solution") {
  const auto& exact = given().body.compliance;
  const auto patches = patches_of(exact, 3, 6);
  REQUIRE(patches.size() == 6);
  // farthest points by the definition
  const auto at = positions(3);
  std::vector<std::size_t> centres = {0};
  while (centres.size() < 6) {
    std::vector<double> distance(at.size(), 1e9);
    for (std::size_t i = 0; i < at.size(); ++i) {
      for (const std::size_t c : centres) distance[i] = std::min(distance[i], (at[i] - at[c]).norm());
    }
    centres.push_back(static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin()));
  }
  double worst = 0;
  for (std::size_t p = 0; p < 6; ++p) {
    CAPTURE(p);
    const double expected = dense_error(exact, given().dense[3], 3, centres[p]);
    CHECK(patches.force_error(given().compressed, 3, p) == doctest::Approx(expected).epsilon(1e-3));
    CHECK(expected > 1e-4);
    worst = std::max(worst, patches.force_error(given().compressed, 3, p));
  }
  CHECK(patches.worst_force_error(given().compressed, 3) == worst);
}

TEST_CASE("chosen patches are those of their number") {
  const auto patches = patches_of(given().body.compliance, 3, 6);
  const auto chosen = patches.choose({4, 1});
  REQUIRE(chosen.size() == 2);
  CHECK(chosen.force_error(given().compressed, 3, 0) == patches.force_error(given().compressed, 3, 4));
  CHECK(chosen.force_error(given().compressed, 3, 1) == patches.force_error(given().compressed, 3, 1));
}

TEST_CASE("no more patches than nodes, no more nodes than there are") {
  const ContactPatches patches(positions(0), 160);
  CHECK(patches.size() == given().compressed.rows(0));
  const auto all = patches_of(given().dense[0], 0, 1);
  CHECK(all.worst_force_error(given().compressed, 0) < 1e-4);
}

TEST_CASE("a patch that is not positive definite has an infinite error") {
  auto model = test::model_of(given().body, layout::Wavelet::lifted_linear, {.threshold = 0.004, .quantum = 0.002});
  for (float& quantum : model.info.quantum) quantum *= 20;
  const test::File file(model);
  const CompressedCompliance<3> indefinite(file.view);
  const auto patches = patches_of(given().body.compliance, 3, 10);
  CHECK(std::isinf(patches.worst_force_error(indefinite, 3)));
}

}  // namespace
}  // namespace greenloop::offline
