#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/write/impulse_response.hpp"

namespace greenloop::offline {

/// The states of a model as it will show them: with the modes that it has, in the numbers of its file.
class ShownStates {
 public:
  /// The model must outlive it. Work: rows times modes.
  explicit ShownStates(const ImpulseResponseData& model);

  /// q_u in an orthonormal basis, m, [modes][rows].
  [[nodiscard]] const Eigen::MatrixXd& coordinates() const { return coordinates_; }
  /// Where the vertices of a row are, m. Work: vertices times modes.
  [[nodiscard]] std::vector<Eigen::Vector3f> positions(Eigen::Index row) const;

 private:
  const ImpulseResponseData& model_;
  Eigen::MatrixXd coordinates_;
};

}  // namespace greenloop::offline
