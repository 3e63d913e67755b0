#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/view.hpp"
#include "offline/compress/wavelet/square_matrix.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {

/// The compliance that a model file of N components, 1 or 3, stands for, in double precision: what the loop's answers
/// are measured with and certified on. Two-sided wavelet form, see formats/layout.hpp. Offline only.
template <unsigned N>
class CompressedCompliance {
 public:
  /// The view may go. Memory: about 80 bytes per coupling, 16 of scalars. Throws std::invalid_argument if the model's
  /// components are not N.
  explicit CompressedCompliance(const ModelView& view);

  [[nodiscard]] std::size_t finest() const { return wavelet_.finest(); }
  [[nodiscard]] std::size_t rows(std::size_t level) const { return wavelet_.row_end(level); }  ///< domain nodes of K
  [[nodiscard]] const SurfaceWavelet& wavelet() const { return wavelet_; }

  /// x = U^_level f: `columns` displacement fields (m) for as many force patterns (N) on the averages of `level` (on
  /// the nodes, if it is the finest). f, x: rows(level) * columns * N numbers, by row, then by column. Zero forces are
  /// skipped. Work: N N * columns per coupling of coefficients that feel a force.
  void apply(std::size_t level, std::size_t columns, const double* f, double* x) const;

  /// The same in wavelet coefficients: (W U^ W^T)_level T^-T f, which T_1^-1 .. T_level^-1 turn into displacements.
  void apply_to_coefficients(std::size_t level, std::size_t columns, const double* f, double* y) const;

  /// What forces on the averages of `level` move on the whole surface, with the details of levels 0 .. `details`: x has
  /// rows(finest()) * columns * N numbers, f as above. With all details its averages of `level` are U^_level f. Work:
  /// as apply, and an inverse transform.
  void displace(std::size_t level, std::size_t details, std::size_t columns, const double* f, double* x) const;

  /// U^_level between some of its nodes: N nodes.size() squared, m/N. Work: N N per coupling of the coefficients that
  /// they feel, and per node that feels one of them.
  [[nodiscard]] Eigen::MatrixXd between(std::size_t level, const std::vector<std::size_t>& nodes) const;

  /// Block column j of U^_level: rows(level) blocks of N N numbers, N c + r.
  [[nodiscard]] std::vector<double> column(std::size_t level, std::size_t j) const;

 private:
  struct Link {
    std::uint32_t other;
    SquareMatrixF<N> block;  // what a force on this coefficient does to the other
  };

  template <class Weight>
  [[nodiscard]] Eigen::MatrixXd between(std::size_t level, const std::vector<std::size_t>& nodes) const;
  void couple(std::size_t level, std::size_t to_level, std::size_t columns, const double* f, double* y) const;
  void link(const ModelView& view);

  SurfaceWavelet wavelet_;
  std::vector<SquareMatrixF<N>> root_, diagonal_;  // [coefficient]
  std::vector<std::size_t> link_begin_;            // [coefficient + 1]
  std::vector<Link> links_;                        // by coefficient, two per coupling
};

}  // namespace greenloop::offline
