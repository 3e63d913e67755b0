#include "offline/appearance/radial_basis.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <utility>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The functions at a point, which sum to 1.
VectorXd functions(const MatrixXd& centres, double width, const VectorXd& point) {
  const VectorXd square = (centres.colwise() - point).colwise().squaredNorm().transpose() / (2 * width * width);
  const VectorXd value = (square.minCoeff() - square.array()).exp();  // the nearest is 1
  return value / value.sum();
}

MatrixXd fitted(const MatrixXd& centres, double width, const MatrixXd& values) {
  constexpr double regularisation = 1e-4;
  MatrixXd at_centres(centres.cols(), centres.cols());
  for (Index k = 0; k < centres.cols(); ++k) at_centres.row(k) = functions(centres, width, centres.col(k)).transpose();
  MatrixXd normal = at_centres.transpose() * at_centres;
  normal.diagonal().array() += regularisation * normal.trace() / static_cast<double>(centres.cols());
  return normal.ldlt().solve(at_centres.transpose() * values.transpose()).transpose();
}

double mean_neighbour_distance(const MatrixXd& centres) {
  double sum = 0;
  for (Index k = 0; k < centres.cols(); ++k) {
    VectorXd square = (centres.colwise() - centres.col(k)).colwise().squaredNorm().transpose();
    square[k] = std::numeric_limits<double>::infinity();
    sum += std::sqrt(square.minCoeff());
  }
  return sum / static_cast<double>(centres.cols());
}

MatrixXd without(const MatrixXd& columns, Index k) {
  MatrixXd rest(columns.rows(), columns.cols() - 1);
  rest << columns.leftCols(k), columns.rightCols(columns.cols() - 1 - k);
  return rest;
}

/// Squared error at each centre of what the others say.
double left_out_error(const MatrixXd& centres, double width, const MatrixXd& values) {
  double sum = 0;
  for (Index k = 0; k < centres.cols(); ++k) {
    const MatrixXd rest = without(centres, k);
    const MatrixXd weights = fitted(rest, width, without(values, k));
    sum += (weights * functions(rest, width, centres.col(k)) - values.col(k)).squaredNorm();
  }
  return sum;
}

}  // namespace

RadialBasis::RadialBasis(MatrixXd centres, const MatrixXd& values) : centres_(std::move(centres)) {
  const double neighbour = centres_.cols() > 1 ? mean_neighbour_distance(centres_) : 1;
  width_ = neighbour;
  double least = std::numeric_limits<double>::infinity();
  for (const double multiple : {0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0}) {
    if (centres_.cols() < 3) break;
    const double error = left_out_error(centres_, multiple * neighbour, values);
    if (error >= least) continue;
    least = error;
    width_ = multiple * neighbour;
  }
  weights_ = fitted(centres_, width_, values);
}

VectorXd RadialBasis::at(const VectorXd& point) const { return weights_ * functions(centres_, width_, point); }

}  // namespace greenloop::offline
