#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace greenloop::offline {

/// The quadratic x' A x - 2 b' x + c: a weighted sum of squared distances to planes and points
/// (Garland, Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997, section 5).
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double c = 0;

  /// weight * squared distance to the plane n'x = offset, n of unit length.
  [[nodiscard]] static Quadric to_plane(double weight, const Eigen::Vector3d& n, double offset) {
    return {weight * n * n.transpose(), weight * offset * n, weight * offset * offset};
  }
  /// weight * squared distance to the point p.
  [[nodiscard]] static Quadric to_point(double weight, const Eigen::Vector3d& p) {
    return {weight * Eigen::Matrix3d::Identity(), weight * p, weight * p.squaredNorm()};
  }

  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }
  [[nodiscard]] friend Quadric operator+(Quadric left, const Quadric& right) { return left += right; }
  [[nodiscard]] friend Quadric operator*(double factor, const Quadric& q) {
    return {factor * q.a, factor * q.b, factor * q.c};
  }

  [[nodiscard]] double at(const Eigen::Vector3d& x) const { return x.dot(a * x) - 2 * b.dot(x) + c; }
  /// Where it is least; A must be positive definite.
  [[nodiscard]] Eigen::Vector3d minimizer() const { return a.ldlt().solve(b); }
};

}  // namespace greenloop::offline
