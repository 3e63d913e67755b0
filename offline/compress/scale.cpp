#include "offline/compress/scale.hpp"

#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <string>

namespace greenloop::offline {

Scale::Scale(const Eigen::Matrix3d& block, std::string_view role, std::size_t index) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(block);
  if (!(solver.eigenvalues().minCoeff() > 0)) {
    throw std::invalid_argument("compression: the compliance is not positive definite: diagonal block of " +
                                std::string(role) + " " + std::to_string(index) + " has the eigenvalue " +
                                std::to_string(solver.eigenvalues().minCoeff()) + " m/N");
  }
  root_ = solver.operatorSqrt();
  inverse_ = solver.operatorInverseSqrt();
}

layout::Scale store_scale(const Eigen::Matrix3d& root) {
  const Eigen::Matrix3f r = root.cast<float>();
  return {{r(0, 0), r(0, 1), r(0, 2), r(1, 1), r(1, 2), r(2, 2)}};
}

Eigen::Matrix3d load_scale(const layout::Scale& scale) {
  const auto& r = scale.root;
  Eigen::Matrix3f root;
  root << r[0], r[1], r[2], r[1], r[3], r[4], r[2], r[4], r[5];
  return root.cast<double>();
}

}  // namespace greenloop::offline
