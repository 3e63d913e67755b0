#include "offline/compress/wavelet/equilibrated_prediction.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using test::Scalars;
using test::Vectors;

template <unsigned N>
SurfaceWavelet wavelet_of(const test::Body& body, const MatrixXd& compliance) {
  return make_wavelet<N>(body.mesh, body.flags, body.area, layout::Wavelet::equilibrated,
                         test::columns_of<N>(compliance));
}

template <unsigned N>
const test::Body& body() {
  static const test::Body value = test::make_body<N>(3);
  return value;
}

template <unsigned N>
const SurfaceWavelet& wavelet() {
  static const SurfaceWavelet value = wavelet_of<N>(body<N>(), body<N>().compliance);
  return value;
}

const Eigen::Vector3d& position(std::size_t row) { return body<1>().mesh.positions[wavelet<1>().nodes()[row]]; }

Matrix3d cross(const Eigen::Vector3d& x) {
  Matrix3d matrix;
  matrix << 0, -x.z(), x.y(), x.z(), 0, -x.x(), -x.y(), x.x(), 0;
  return matrix;
}

template <class Visit>
void visit_odds(const SurfaceWavelet& on, Visit visit) {
  for (std::size_t level = 1; level <= on.finest(); ++level) {
    for (const auto& odd : on.odds(level)) visit(level, odd);
  }
}

template <unsigned N>
using Terms = std::vector<test::PredictionTerm<N>>;

// root mean square distance of the nodes that predict one
template <unsigned N>
double reach(const SurfaceWavelet::Odd& odd, const Terms<N>& terms) {
  double sum = 0;
  for (const auto& term : terms) sum += (position(term.row) - position(odd.row)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(terms.size()));
}

TEST_CASE("the force pattern of a detail has no net force and no net moment, where Linear wavelets leave a moment") {
  double linear_moment = 0;
  visit_odds(wavelet<3>(), [&](std::size_t, const SurfaceWavelet::Odd& odd) {
    Matrix3d force = Matrix3d::Identity(), moment = Matrix3d::Zero();
    const auto terms = test::prediction_of<3>(wavelet<3>(), odd);
    for (const auto& [row, weight] : terms) {
      force -= weight.transpose();
      moment -= cross(position(row) - position(odd.row)) * weight.transpose();
    }
    CHECK(force.norm() < 5e-3);
    CHECK(moment.norm() < 5e-3 * reach<3>(odd, terms));
    Matrix3d halves = Matrix3d::Zero();
    for (const auto& [row, weight] : odd.prediction()) halves -= weight * cross(position(row) - position(odd.row));
    linear_moment = std::max(linear_moment, halves.norm() / reach<3>(odd, terms));
  });
  CHECK(linear_moment > 0.1);
}

TEST_CASE("the sources of a scalar detail cancel") {
  CHECK(!wavelet<1>().has_blocks());
  visit_odds(wavelet<1>(), [](std::size_t, const SurfaceWavelet::Odd& odd) {
    double sum = 1;
    for (const auto& term : odd.prediction()) sum -= term.weight;
    CHECK(std::abs(sum) < 5e-3);
  });
}

// what prediction leaves of the nodes' own compliances, over all odd nodes
template <unsigned N>
double left_over(const SurfaceWavelet& wavelet) {
  const test::Sparse step = test::forward_step<N>(wavelet, wavelet.finest());
  const MatrixXd left = step * body<N>().compliance * step.transpose();
  return left.diagonal().tail(block_begin<N>(wavelet.odds(wavelet.finest()).size())).sum();
}

TEST_CASE_TEMPLATE("less is left of the nodes than by the middle of their parents", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const SurfaceWavelet halves(body<N>().mesh, body<N>().flags, body<N>().area, layout::Wavelet::linear);
  const double ratio = left_over<N>(wavelet<N>()) / left_over<N>(halves);
  MESSAGE("left with ", N, " numbers a node, relative to the middle of the parents: ", ratio);
  CHECK(ratio < 0.95);
}

TEST_CASE_TEMPLATE("a node is predicted from different coarser nodes, all among the nearest in space", T, Scalars,
                   Vectors) {
  constexpr unsigned N = T::value;
  visit_odds(wavelet<N>(), [&](std::size_t level, const SurfaceWavelet::Odd& odd) {
    const auto terms = test::prediction_of<N>(wavelet<N>(), odd);
    const std::size_t end = wavelet<N>().row_end(level - 1), count = std::min<std::size_t>(6, end);
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

// what Kriging reproduces at `arm` from the node: a constant, rigid motions
SquareMatrix<1> drift(const Eigen::Vector3d&, Scalars) { return SquareMatrix<1>::Ones(); }

Eigen::Matrix<double, 3, 6> drift(const Eigen::Vector3d& arm, Vectors) {
  Eigen::Matrix<double, 3, 6> motions = Eigen::Matrix<double, 3, 6>::Identity();
  motions.rightCols<3>() = -cross(arm);
  return motions;
}

// Universal Kriging by its own equations: U_NN P^T + F_N L = U_Nm, F_N^T P^T = F_m^T with a Lagrange multiplier L.
template <unsigned N>
MatrixXd kriged_weights(const SurfaceWavelet::Odd& odd, const Terms<N>& terms) {
  using Components = std::integral_constant<unsigned, N>;
  const double scale = body<N>().compliance(0, 0), h = reach<N>(odd, terms);
  const auto at_node = drift(Eigen::Vector3d::Zero(), Components());
  constexpr Index drifts = N == 1 ? 1 : 6;
  const Index n = block_begin<N>(terms.size());
  MatrixXd system = MatrixXd::Zero(n + drifts, n + drifts), right(n + drifts, N);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Index at = block_begin<N>(i), row = block_begin<N>(terms[i].row);
    for (std::size_t k = 0; k < terms.size(); ++k) {
      system.block<N, N>(at, block_begin<N>(k)) =
          body<N>().compliance.template block<N, N>(row, block_begin<N>(terms[k].row)) / scale;
    }
    system.block<N, drifts>(at, n) = drift((position(terms[i].row) - position(odd.row)) / h, Components());
    right.middleRows<N>(at) = body<N>().compliance.template block<N, N>(row, block_begin<N>(odd.row)) / scale;
  }
  system.bottomRows<drifts>().leftCols(n) = system.rightCols<drifts>().topRows(n).transpose();
  right.bottomRows<drifts>() = at_node.transpose();
  return system.fullPivLu().solve(right).topRows(n).transpose();
}

TEST_CASE_TEMPLATE("weights are those of Kriging with the compliance that reproduces the drift", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  double worst = 0;
  std::size_t checked = 0;
  visit_odds(wavelet<N>(), [&](std::size_t, const SurfaceWavelet::Odd& odd) {
    const auto terms = test::prediction_of<N>(wavelet<N>(), odd);
    const MatrixXd expected = kriged_weights<N>(odd, terms);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const SquareMatrix<N> own = expected.middleCols<N>(block_begin<N>(i));
      worst = std::max(worst, (terms[i].weight - own).cwiseAbs().maxCoeff());
    }
    ++checked;
  });
  CHECK(checked > 100);
  CHECK(worst < 0.02);  // of weights about 1: the drift's variance is finite
  CHECK(worst > 1e-5);  // they are rounded
}

TEST_CASE_TEMPLATE("the same columns give the same predictions, and so does a body that is softer as a whole", T,
                   Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const SurfaceWavelet again = wavelet_of<N>(body<N>(), body<N>().compliance);
  const MatrixXd softer = 1024 * body<N>().compliance;  // a power of two: the same digits
  const SurfaceWavelet scaled = wavelet_of<N>(body<N>(), softer);
  for (std::size_t level = 1; level <= wavelet<N>().finest(); ++level) {
    CHECK(again.predictions(level).index == wavelet<N>().predictions(level).index);
    CHECK(again.predictions(level).weight == wavelet<N>().predictions(level).weight);
    CHECK(scaled.predictions(level).weight == wavelet<N>().predictions(level).weight);
  }
}

// a node that moves 100,000 times as much as those it is predicted from
TEST_CASE_TEMPLATE("weights that 16 bits do not hold give way to the middle of the parents", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  MatrixXd compliance = body<N>().compliance;
  const auto odd = wavelet<N>().odds(wavelet<N>().finest())[7];
  compliance.middleRows<N>(block_begin<N>(odd.row)) *= 1e5;
  compliance.middleCols<N>(block_begin<N>(odd.row)) *= 1e5;
  const SurfaceWavelet other = wavelet_of<N>(body<N>(), compliance);
  std::ptrdiff_t halves = 0;
  for (const auto& [from, weight] : test::prediction_of<N>(other, other.odds(other.finest())[7])) {
    const bool parent = (from == odd.parent[0] || from == odd.parent[1]) && !weight.isZero(0);
    CHECK((parent ? weight == 0.5 * SquareMatrix<N>::Identity() : weight.isZero(0)));
    halves += parent ? 1 : 0;
  }
  CHECK(halves == 2 - std::count(odd.parent, odd.parent + 2, SurfaceWavelet::no_row));
}

TEST_CASE_TEMPLATE("columns that are not finite are refused, as is Equilibrated prediction without weights", T, Scalars,
                   Vectors) {
  constexpr unsigned N = T::value;
  const test::Body& own = body<N>();
  MatrixXd broken = own.compliance;
  broken(4, 2) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS((void)wavelet_of<N>(own, broken), doctest::Contains("exact columns 0 to"),
                       std::invalid_argument);
  CHECK_THROWS_AS(SurfaceWavelet(own.mesh, own.flags, own.area, layout::Wavelet::equilibrated), std::invalid_argument);
  const std::vector<PredictionsData> too_few(wavelet<N>().finest());
  CHECK_THROWS_AS(SurfaceWavelet(own.mesh, own.flags, own.area, too_few, N), std::invalid_argument);
}

TEST_CASE("predictions of other components are refused") {
  for (const unsigned other : {1U, 3U}) {
    const SurfaceWavelet& from = other == 1 ? wavelet<3>() : wavelet<1>();
    std::vector<PredictionsData> predictions;
    for (std::size_t level = 0; level <= from.finest(); ++level) predictions.push_back(from.predictions(level));
    CHECK_THROWS_AS(SurfaceWavelet(body<1>().mesh, body<1>().flags, body<1>().area, predictions, other),
                    std::invalid_argument);
  }
}

TEST_CASE_TEMPLATE("a mesh of one level has nothing to predict", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const test::Body flat = test::make_body<N>(0);
  CHECK(wavelet_of<N>(flat, flat.compliance).finest() == 0);
}

}  // namespace
}  // namespace greenloop::offline
