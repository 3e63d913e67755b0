#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {

/// The surface of a body as fingers find it: contacts are chosen among its points, which are the touchable domain rows.
/// Offline only.
class TouchedSurface {
 public:
  /// `flags`, `area` [m^2] per node of the mesh. Normals follow the finest triangles, outward by the sign of the
  /// enclosed volume. Work: linear.
  TouchedSurface(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, const std::vector<double>& area,
                 const SurfaceWavelet& wavelet);

  [[nodiscard]] std::size_t size() const { return row_.size(); }
  [[nodiscard]] std::size_t row(std::size_t point) const { return row_[point]; }                   ///< in the domain
  [[nodiscard]] const std::vector<Eigen::Vector3d>& positions() const { return position_; }        ///< m
  [[nodiscard]] const Eigen::Vector3d& normal(std::size_t point) const { return normal_[point]; }  ///< unit, outward
  [[nodiscard]] double area(std::size_t point) const { return area_[point]; }                      ///< m^2

  /// The `count` points nearest to a place among those whose normals make less than a right angle with `direction`,
  /// the nearest first; of all points if the direction is zero. Fewer if there are fewer.
  [[nodiscard]] std::vector<std::size_t> nearest_facing(const Eigen::Vector3d& place, const Eigen::Vector3d& direction,
                                                        std::size_t count) const;

  /// How far the inward normal of a point runs through the body [m]; none if it leaves it nowhere. Work: linear in the
  /// triangles.
  [[nodiscard]] std::optional<double> thickness(std::size_t point) const;

 private:
  std::vector<Eigen::Vector3d> vertex_;
  std::vector<std::array<int, 3>> triangle_;
  std::vector<std::size_t> row_, node_;  // by point
  std::vector<Eigen::Vector3d> position_, normal_;
  std::vector<double> area_;
};

}  // namespace greenloop::offline
