#pragma once

#include <Eigen/Core>
#include <vector>

namespace greenloop::offline {

/// The range of a matrix A that is shown once, block of columns by block of columns, and may be larger than memory: an
/// orthonormal basis W and coordinates C with A = W C + E and ||E||_F <= tolerance * sigma_1(A), so that every singular
/// value of C is within that of A's (Weyl). What of a block lies outside of W is measured; the leading directions of
/// it join W as far as the tolerance, spread evenly over all columns, asks (Brand 2002, "Incremental singular value
/// decomposition", with the residual's eigenvectors in the place of its QR). W only grows; when it reaches `most`
/// modes less a block, the directions of least weight are given up if the tolerance allows.
/// W and blocks are float, whose rounding limits the error to about 1e-7 sigma_1; sums of squares and C are double.
/// Memory: rows * (most + columns of a block) floats and most * columns doubles.
class StreamingBasis {
 public:
  /// columns: that will be added in all. Throws std::invalid_argument unless all are positive.
  StreamingBasis(Eigen::Index rows, Eigen::Index columns, double tolerance, Eigen::Index most);

  /// Adds columns; `block` is used up. Throws std::runtime_error if more than `most` modes would be needed. Work:
  /// 4 rows modes columns, and 4 rows columns^2 more if the basis grows.
  void add(Eigen::Ref<Eigen::MatrixXf> block);

  [[nodiscard]] Eigen::Index modes() const { return modes_; }
  /// W, [rows][modes].
  [[nodiscard]] Eigen::Ref<const Eigen::MatrixXf> basis() const { return basis_.leftCols(modes_); }
  /// C, [modes][columns added].
  [[nodiscard]] Eigen::MatrixXd coordinates() const;
  /// Squared norm of each column of E.
  [[nodiscard]] const std::vector<double>& dropped() const { return dropped_; }

 private:
  [[nodiscard]] double allowance(double largest = 0) const;
  void project_out(Eigen::Ref<Eigen::MatrixXf> block, Eigen::MatrixXd& coordinates) const;
  void grow(Eigen::Ref<Eigen::MatrixXf> block, Eigen::MatrixXd& coordinates);
  Eigen::Index join(Eigen::MatrixXf directions);
  void give_up_least(Eigen::Index most);
  void count_weight(const Eigen::MatrixXd& coordinates);

  Eigen::Index columns_;
  double tolerance_;
  Eigen::MatrixXf basis_;  // [rows][most]
  Eigen::Index modes_ = 0;
  std::vector<Eigen::MatrixXd> coordinates_;  // of each block, by the modes there were
  Eigen::MatrixXd weight_;                    // C C^T
  std::vector<double> dropped_;
  double dropped_sum_ = 0;
};

}  // namespace greenloop::offline
