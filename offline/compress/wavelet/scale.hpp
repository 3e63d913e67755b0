#pragma once

#include <cstddef>

#include "formats/layout.hpp"
#include "offline/compress/wavelet/square_matrix.hpp"

namespace greenloop::offline {

/// How a coefficient's couplings are scaled: by the symmetric root of its *conditional* compliance, what is left of its
/// diagonal block once the coefficients around it are held. A force that meets stiff surroundings feels errors relative
/// to that, not to the diagonal block; on thin parts the two differ a hundredfold. N: numbers of a coefficient, 1 or 3.
template <unsigned N>
class CoefficientScale {
 public:
  /// Both m/N. Throws std::invalid_argument naming the coefficient if `conditional` is not positive definite.
  CoefficientScale(const SquareMatrix<N>& diagonal, const SquareMatrix<N>& conditional, std::size_t coefficient);

  [[nodiscard]] const SquareMatrix<N>& root() const { return root_; }
  [[nodiscard]] const SquareMatrix<N>& inverse() const { return inverse_; }
  [[nodiscard]] const SquareMatrix<N>& diagonal() const { return diagonal_; }  ///< scaled: identity or larger

  /// As the model file stores it: rounded, so that it takes fewer bytes to transmit, the root to round-off, the
  /// diagonal to what is little beside `quantum`, that of the couplings' values.
  [[nodiscard]] layout::Scale<N> stored(double quantum) const;

 private:
  SquareMatrix<N> root_, inverse_, diagonal_;
};

/// A symmetric 3x3 matrix from its six numbers xx, xy, xz, yy, yz, zz.
[[nodiscard]] SquareMatrix<3> symmetric_matrix(const float (&six)[6]);

/// A 1x1 matrix from its number.
[[nodiscard]] SquareMatrix<1> symmetric_matrix(const float (&one)[1]);

}  // namespace greenloop::offline
