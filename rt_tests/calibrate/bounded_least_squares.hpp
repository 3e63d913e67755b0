#pragma once

#include <Eigen/Core>

namespace greenloop {

/// The x that minimises x^T G x / 2 - b^T x subject to x >= lower, for the normal equations of a least-squares problem,
/// G = A^T A and b = A^T y (Lawson & Hanson, Solving Least Squares Problems, chapter 23). Where columns of A depend on
/// each other one of the solutions; a column of zeros stays at its bound. gram: [n x n] symmetric, positive
/// semidefinite; rhs, lower: [n]. Throws std::invalid_argument if their sizes differ. Offline only.
[[nodiscard]] Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                                                    const Eigen::VectorXd& lower);

}  // namespace greenloop
