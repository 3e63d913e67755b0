#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string_view>

#include "formats/layout.hpp"

namespace greenloop::offline {

/// The symmetric root of a coefficient's diagonal block, and its inverse.
class Scale {
 public:
  /// `block`: 3x3, m/N. Throws std::invalid_argument naming `role` and `index` if it is not positive definite.
  Scale(const Eigen::Matrix3d& block, std::string_view role, std::size_t index);

  [[nodiscard]] const Eigen::Matrix3d& root() const { return root_; }
  [[nodiscard]] const Eigen::Matrix3d& inverse() const { return inverse_; }

 private:
  Eigen::Matrix3d root_, inverse_;
};

[[nodiscard]] layout::Scale store_scale(const Eigen::Matrix3d& root);
[[nodiscard]] Eigen::Matrix3d load_scale(const layout::Scale& scale);

}  // namespace greenloop::offline
