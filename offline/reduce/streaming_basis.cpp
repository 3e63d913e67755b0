#include "offline/reduce/streaming_basis.hpp"

#include <cblas.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;

// Directions of a block down to this part of the largest eigenvalue of its Gram matrix are taken at a time: float then
// keeps four digits of the least of them, and making them orthonormal once more the rest.
constexpr double least_eigenvalue = 1e-6;

// A new direction of which less than this, squared, lies outside of the basis is rounding.
constexpr double least_outside = 0.25;

// rows that are rotated or widened at a time
constexpr Index strip = 1024;

int blas(Index size) { return static_cast<int>(size); }

/// W^T B.
MatrixXf projected(const Eigen::Ref<const MatrixXf>& basis, const Eigen::Ref<const MatrixXf>& block) {
  MatrixXf product(basis.cols(), block.cols());
  cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, blas(basis.cols()), blas(block.cols()), blas(basis.rows()), 1,
              basis.data(), blas(basis.outerStride()), block.data(), blas(block.outerStride()), 0, product.data(),
              blas(product.rows()));
  return product;
}

/// B -= W P.
void subtract(const Eigen::Ref<const MatrixXf>& basis, const MatrixXf& part, Eigen::Ref<MatrixXf> block) {
  cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, blas(basis.rows()), blas(part.cols()), blas(basis.cols()), -1,
              basis.data(), blas(basis.outerStride()), part.data(), blas(part.rows()), 1, block.data(),
              blas(block.outerStride()));
}

/// B T.
MatrixXf combined(const Eigen::Ref<const MatrixXf>& block, const MatrixXd& turn) {
  MatrixXf result = MatrixXf::Zero(block.rows(), turn.cols());
  subtract(block, -turn.cast<float>(), result);
  return result;
}

/// B^T B, in double.
MatrixXd gram(const Eigen::Ref<const MatrixXf>& block) {
  MatrixXd sum = MatrixXd::Zero(block.cols(), block.cols());
  for (Index row = 0; row < block.rows(); row += strip) {
    const MatrixXd part = block.middleRows(row, std::min(strip, block.rows() - row)).cast<double>();
    cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, blas(part.cols()), blas(part.cols()), blas(part.rows()), 1,
                part.data(), blas(part.rows()), part.data(), blas(part.rows()), 1, sum.data(), blas(sum.rows()));
  }
  return sum;
}

/// Squared norms of columns, in double.
std::vector<double> squares(const Eigen::Ref<const MatrixXf>& block) {
  std::vector<double> sums(static_cast<std::size_t>(block.cols()));
  for (Index c = 0; c < block.cols(); ++c)
    sums[static_cast<std::size_t>(c)] = block.col(c).cast<double>().squaredNorm();
  return sums;
}

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// How many of ascending eigenvalues, from the least, may go within the allowance.
Index least_within(const Eigen::VectorXd& ascending, double allowance) {
  Index count = 0;
  for (double sum = 0; count < ascending.size(); ++count) {
    sum += std::max(ascending[count], 0.0);
    if (sum > allowance) break;
  }
  return count;
}

/// Coordinates with rows of zeros below.
MatrixXd padded(const MatrixXd& coordinates, Index rows) {
  MatrixXd result = MatrixXd::Zero(rows, coordinates.cols());
  result.topRows(coordinates.rows()) = coordinates;
  return result;
}

}  // namespace

StreamingBasis::StreamingBasis(Index rows, Index columns, double tolerance, Index most)
    : columns_(columns), tolerance_(tolerance) {
  if (rows < 1 || columns < 1 || !(tolerance > 0) || most < 1) {
    throw std::invalid_argument("streaming basis: rows, columns, tolerance and modes must be positive");
  }
  basis_.resize(rows, most);
}

// The squared norm of what may still be dropped of the columns so far. sigma_1^2 is at least ||C C^T||_F^2 / trace, and
// `largest`, an eigenvalue of what is left of a block, so that it is never taken too large.
double StreamingBasis::allowance(double largest) const {
  const double trace = weight_.size() == 0 ? 0 : weight_.trace();
  if (trace > 0) largest = std::max(largest, weight_.squaredNorm() / trace);
  const double part = static_cast<double>(dropped_.size()) / static_cast<double>(columns_);
  return std::max(0.0, tolerance_ * tolerance_ * largest * part - dropped_sum_);
}

void StreamingBasis::project_out(Eigen::Ref<MatrixXf> block, MatrixXd& coordinates) const {
  if (modes_ == 0) return;
  const MatrixXf part = projected(basis(), block);
  subtract(basis(), part, block);
  coordinates += part.cast<double>();
}

void StreamingBasis::count_weight(const MatrixXd& coordinates) {
  if (weight_.rows() < modes_) {
    MatrixXd wider = MatrixXd::Zero(modes_, modes_);
    wider.topLeftCorner(weight_.rows(), weight_.cols()) = weight_;
    weight_ = std::move(wider);
  }
  weight_.noalias() += coordinates * coordinates.transpose();
}

void StreamingBasis::add(Eigen::Ref<MatrixXf> block) {
  if (modes_ + block.cols() > basis_.cols()) give_up_least(basis_.cols() - block.cols());
  MatrixXd coordinates = MatrixXd::Zero(modes_, block.cols());
  project_out(block, coordinates);
  count_weight(coordinates);
  dropped_.resize(dropped_.size() + static_cast<std::size_t>(block.cols()), 0.0);
  auto left = squares(block);
  if (sum_of(left) > allowance()) {
    weight_.noalias() -= coordinates * coordinates.transpose();
    grow(block, coordinates);
    count_weight(coordinates);
    left = squares(block);
  }
  std::copy(left.begin(), left.end(), dropped_.end() - static_cast<std::ptrdiff_t>(left.size()));
  dropped_sum_ += sum_of(left);
  coordinates_.push_back(std::move(coordinates));
}

// Twice is enough: what is left of a column after one projection still has a part in W as large as float rounds.
void StreamingBasis::grow(Eigen::Ref<MatrixXf> block, MatrixXd& coordinates) {
  double largest = 0;
  for (double before = sum_of(squares(block)); before > allowance(largest);) {
    project_out(block, coordinates);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram(block));
    const auto& lambda = eigen.eigenvalues();
    const Index count = block.cols();
    if (!(lambda[count - 1] > 0)) return;
    largest = std::max(largest, lambda[count - 1]);
    Index wanted = count - least_within(lambda, allowance(largest));
    while (wanted > 1 && lambda[count - wanted] < least_eigenvalue * lambda[count - 1]) --wanted;
    if (wanted == 0) return;
    const Eigen::VectorXd scale = lambda.tail(wanted).cwiseSqrt().cwiseInverse();
    const Index joined = join(combined(block, eigen.eigenvectors().rightCols(wanted) * scale.asDiagonal()));
    const auto fresh = basis_.middleCols(modes_ - joined, joined);
    const MatrixXf part = projected(fresh, block);
    subtract(fresh, part, block);
    coordinates = padded(coordinates, modes_);
    coordinates.bottomRows(joined) = part.cast<double>();
    const double after = sum_of(squares(block));
    if (!(after < 0.25 * before)) return;  // only rounding is left
    before = after;
  }
}

// Makes directions orthonormal, to W and to each other, and adds those that rounding did not make. Returns how many.
Index StreamingBasis::join(MatrixXf directions) {
  if (modes_ > 0) subtract(basis(), projected(basis(), directions), directions);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram(directions));
  const auto& length = eigen.eigenvalues();
  const Index joined = std::min<Index>((length.array() > least_outside).count(), basis_.cols() - modes_);
  const Eigen::VectorXd scale = length.tail(joined).cwiseSqrt().cwiseInverse();
  basis_.middleCols(modes_, joined) = combined(directions, eigen.eigenvectors().rightCols(joined) * scale.asDiagonal());
  modes_ += joined;
  return joined;
}

void StreamingBasis::give_up_least(Index most) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(weight_);
  const Index gone = least_within(eigen.eigenvalues(), allowance() / 2);
  const Index kept = modes_ - gone;
  if (kept > most) {
    throw std::runtime_error("reduction: more than " + std::to_string(basis_.cols()) +
                             " modes are needed for a relative error of " + std::to_string(tolerance_) +
                             " while frames are read; ask for less accuracy, or give more memory");
  }
  const MatrixXd turn = eigen.eigenvectors().rightCols(kept);
  const MatrixXf turn_float = turn.cast<float>();
  for (Index row = 0; row < basis_.rows(); row += strip) {
    const Index count = std::min(strip, basis_.rows() - row);
    const MatrixXf turned = basis_.block(row, 0, count, modes_) * turn_float;
    basis_.block(row, 0, count, kept) = turned;
  }
  std::size_t column = 0;
  for (MatrixXd& coordinates : coordinates_) {
    const MatrixXd turned = eigen.eigenvectors().transpose() * padded(coordinates, modes_);
    for (Index c = 0; c < turned.cols(); ++c) dropped_[column++] += turned.col(c).head(gone).squaredNorm();
    coordinates = turned.bottomRows(kept);
  }
  dropped_sum_ = sum_of(dropped_);
  weight_ = eigen.eigenvalues().tail(kept).asDiagonal();
  modes_ = kept;
}

MatrixXd StreamingBasis::coordinates() const {
  MatrixXd all = MatrixXd::Zero(modes_, static_cast<Index>(dropped_.size()));
  Index column = 0;
  for (const MatrixXd& coordinates : coordinates_) {
    all.block(0, column, coordinates.rows(), coordinates.cols()) = coordinates;
    column += coordinates.cols();
  }
  return all;
}

}  // namespace greenloop::offline
