#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "offline/compress/measure/contact_patches.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {

/// An exact column to compare with.
struct SampleColumn {
  std::size_t row = 0;
  double area = 0;            ///< m^2
  std::vector<double> exact;  ///< rows blocks of 9
};

/// Positions of the domain rows of K(level) [m].
[[nodiscard]] std::vector<Eigen::Vector3d> row_positions(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet,
                                                         std::size_t level);

/// Column j of `columns` as rows blocks of 9, 3 c + r.
[[nodiscard]] std::vector<double> blocks_of(const Eigen::MatrixXd& columns, std::size_t j);

/// What encodings of the finest level are compared with, gathered while the exact columns stream by.
class ExactSample {
 public:
  static constexpr std::size_t most_patches = 160;
  static constexpr std::size_t most_columns = 64;  ///< evenly spaced

  /// `area` [m^2] per node of the mesh.
  ExactSample(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet, const std::vector<double>& area);

  /// Exact columns from `first` on, m/N.
  void add(const Eigen::MatrixXd& block, std::size_t first);

  [[nodiscard]] const ContactPatches& patches() const { return patches_; }
  [[nodiscard]] const std::vector<SampleColumn>& columns() const { return columns_; }

 private:
  ContactPatches patches_;
  std::vector<SampleColumn> columns_;
};

}  // namespace greenloop::offline
