#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace greenloop::offline {

/// Coordinates of a displacement field that keep distances roughly: sums of its values with random signs (Achlioptas
/// 2003). Of k coordinates, a squared length is off by a factor of 1 +- sqrt(2 / k), as standard deviation.
class Projection {
 public:
  /// `rest`: positions from which displacements count, three numbers a vertex.
  Projection(std::vector<float> rest, int coordinates);

  [[nodiscard]] int coordinates() const { return coordinates_; }
  /// In m, with the length of the field as root mean square over vertices. Work: values times coordinates.
  [[nodiscard]] Eigen::VectorXf of(std::span<const float> positions) const;

 private:
  std::vector<float> rest_;
  int coordinates_;
  std::vector<std::uint64_t> signs_;  // of each value, a bit a coordinate
};

}  // namespace greenloop::offline
