#include "offline/compress/wavelet/equilibrated_prediction.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

const test::Body& body() {
  static const test::Body value = test::make_body(3);
  return value;
}

const SurfaceWavelet& wavelet() {
  static const SurfaceWavelet value = make_wavelet(body().mesh, body().flags, body().area,
                                                   layout::Wavelet::equilibrated, test::columns_of(body().compliance));
  return value;
}

const Eigen::Vector3d& position(std::size_t row) { return body().mesh.positions[wavelet().nodes()[row]]; }

Matrix3d cross(const Eigen::Vector3d& x) {
  Matrix3d matrix;
  matrix << 0, -x.z(), x.y(), x.z(), 0, -x.x(), -x.y(), x.x(), 0;
  return matrix;
}

template <class Visit>
void visit_odds(Visit visit) {
  for (std::size_t level = 1; level <= wavelet().finest(); ++level) {
    for (const auto& odd : wavelet().odds(level)) visit(level, odd);
  }
}

// root mean square distance of the nodes that predict one
double reach(const SurfaceWavelet::Odd& odd) {
  double sum = 0;
  const auto terms = wavelet().block_prediction(odd);
  for (const auto& term : terms) sum += (position(term.row) - position(odd.row)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(terms.size()));
}

TEST_CASE("the force pattern of a detail has no net force and no net moment, where Linear wavelets leave a moment") {
  double linear_moment = 0;
  visit_odds([&](std::size_t, const SurfaceWavelet::Odd& odd) {
    Matrix3d force = Matrix3d::Identity(), moment = Matrix3d::Zero();
    for (const auto& [row, weight] : wavelet().block_prediction(odd)) {
      force -= weight.transpose();
      moment -= cross(position(row) - position(odd.row)) * weight.transpose();
    }
    CHECK(force.norm() < 5e-3);
    CHECK(moment.norm() < 5e-3 * reach(odd));
    Matrix3d halves = Matrix3d::Zero();
    for (const auto& [row, weight] : odd.prediction()) halves -= weight * cross(position(row) - position(odd.row));
    linear_moment = std::max(linear_moment, halves.norm() / reach(odd));
  });
  CHECK(linear_moment > 0.1);
}

TEST_CASE("a node is predicted from different coarser nodes, all among the nearest in space") {
  visit_odds([&](std::size_t level, const SurfaceWavelet::Odd& odd) {
    const auto terms = wavelet().block_prediction(odd);
    const std::size_t end = wavelet().row_end(level - 1), count = std::min<std::size_t>(6, end);
    REQUIRE(terms.size() == count);
    std::set<std::uint32_t> rows;
    for (const auto& term : terms) {
      CHECK(term.row < end);
      rows.insert(term.row);
      std::size_t nearer = 0;
      for (std::size_t row = 0; row < end; ++row) {
        nearer += (position(row) - position(odd.row)).norm() < (position(term.row) - position(odd.row)).norm() ? 1 : 0;
      }
      CHECK(nearer < 3 * count);
    }
    CHECK(rows.size() == count);
  });
}

// Universal Kriging by its own equations: U_NN P^T + F_N L = U_Nm, F_N^T P^T = F_m^T with a Lagrange multiplier L.
TEST_CASE("weights are those of Kriging with the compliance that reproduces rigid motions") {
  double worst = 0;
  std::size_t checked = 0;
  visit_odds([&](std::size_t, const SurfaceWavelet::Odd& odd) {
    const auto terms = wavelet().block_prediction(odd);
    const auto n = static_cast<Index>(3 * terms.size());
    MatrixXd system = MatrixXd::Zero(n + 6, n + 6), right = MatrixXd::Zero(n + 6, 3);
    const double scale = body().compliance(0, 0), h = reach(odd);
    for (Index i = 0; i < n / 3; ++i) {
      const auto row = static_cast<Index>(3 * terms[static_cast<std::size_t>(i)].row);
      for (Index k = 0; k < n / 3; ++k) {
        const auto other = static_cast<Index>(3 * terms[static_cast<std::size_t>(k)].row);
        system.block<3, 3>(3 * i, 3 * k) = body().compliance.block<3, 3>(row, other) / scale;
      }
      system.block<3, 3>(3 * i, n).setIdentity();
      system.block<3, 3>(3 * i, n + 3) =
          -cross(position(terms[static_cast<std::size_t>(i)].row) - position(odd.row)) / h;
      right.middleRows<3>(3 * i) = body().compliance.block<3, 3>(row, static_cast<Index>(3 * odd.row)) / scale;
    }
    system.bottomLeftCorner(6, n) = system.topRightCorner(n, 6).transpose();
    right.middleRows<3>(n).setIdentity();
    const MatrixXd solved = system.fullPivLu().solve(right);
    for (Index i = 0; i < n / 3; ++i) {
      const Matrix3d expected = solved.middleRows<3>(3 * i).transpose();
      worst = std::max(worst, (terms[static_cast<std::size_t>(i)].weight - expected).cwiseAbs().maxCoeff());
    }
    ++checked;
  });
  CHECK(checked > 100);
  CHECK(worst < 0.02);  // of weights about 1: the drift's variance is finite
  CHECK(worst > 1e-5);  // they are rounded
}

TEST_CASE("the same columns give the same predictions, and so does a body that is softer as a whole") {
  const SurfaceWavelet again = make_wavelet(body().mesh, body().flags, body().area, layout::Wavelet::equilibrated,
                                            test::columns_of(body().compliance));
  const MatrixXd softer = 1024 * body().compliance;  // a power of two: the same digits
  const SurfaceWavelet scaled =
      make_wavelet(body().mesh, body().flags, body().area, layout::Wavelet::equilibrated, test::columns_of(softer));
  for (std::size_t level = 1; level <= wavelet().finest(); ++level) {
    CHECK(again.predictions(level).index == wavelet().predictions(level).index);
    CHECK(again.predictions(level).weight == wavelet().predictions(level).weight);
    CHECK(scaled.predictions(level).weight == wavelet().predictions(level).weight);
  }
}

// a node that moves 100,000 times as much as those it is predicted from
TEST_CASE("weights that 16 bits do not hold give way to the middle of the parents") {
  MatrixXd compliance = body().compliance;
  const auto odd = wavelet().odds(wavelet().finest())[7];
  const auto row = static_cast<Index>(3 * odd.row);
  compliance.middleRows<3>(row) *= 1e5;
  compliance.middleCols<3>(row) *= 1e5;
  const SurfaceWavelet other =
      make_wavelet(body().mesh, body().flags, body().area, layout::Wavelet::equilibrated, test::columns_of(compliance));
  const auto terms = other.block_prediction(other.odds(other.finest())[7]);
  std::size_t halves = 0;
  for (const auto& [from, weight] : terms) {
    const bool parent = (from == odd.parent[0] || from == odd.parent[1]) && !weight.isZero(0);
    CHECK((parent ? weight == 0.5 * Matrix3d::Identity() : weight.isZero(0)));
    halves += parent ? 1 : 0;
  }
  CHECK(halves == odd.terms);
}

TEST_CASE("columns that are not finite are refused, as is Equilibrated prediction without weights") {
  MatrixXd broken = body().compliance;
  broken(4, 2) = std::numeric_limits<double>::quiet_NaN();
  std::string message;
  try {
    (void)make_wavelet(body().mesh, body().flags, body().area, layout::Wavelet::equilibrated, test::columns_of(broken));
  } catch (const std::invalid_argument& error) {
    message = error.what();
  }
  CHECK(message.find("exact columns 0 to") != std::string::npos);
  CHECK_THROWS_AS(SurfaceWavelet(body().mesh, body().flags, body().area, layout::Wavelet::equilibrated),
                  std::invalid_argument);
  const std::vector<PredictionsData> too_few(wavelet().finest());
  CHECK_THROWS_AS(SurfaceWavelet(body().mesh, body().flags, body().area, too_few), std::invalid_argument);
}

TEST_CASE("a mesh of one level has nothing to predict") {
  const test::Body flat = test::make_body(0);
  const SurfaceWavelet one =
      make_wavelet(flat.mesh, flat.flags, flat.area, layout::Wavelet::equilibrated, test::columns_of(flat.compliance));
  CHECK(one.finest() == 0);
}

}  // namespace
}  // namespace greenloop::offline
