#pragma once

#include <span>

namespace greenloop::offline {

/// Errors of compressed columns against exact ones, traction form Xi = U diag(area): the measure of James and Pai 2003,
/// section 9.
class FieldError {
 public:
  /// Adds a column; `found`, `exact`: blocks of 9, 3 c + r, m/N; `area` [m^2] of the column's node. Returns its share
  /// of worst_column.
  double add(std::span<const double> found, const double* exact, double area);

  [[nodiscard]] double rms() const;            ///< ||Xi^ - Xi||_F / ||Xi||_F over the columns added
  [[nodiscard]] double worst_column() const {  ///< max_j ||Xi^_j - Xi_j||_inf / ||Xi_j||_inf, block-wise Frobenius
    return worst_column_;
  }

 private:
  double error_energy_ = 0, exact_energy_ = 0, worst_column_ = 0;
};

}  // namespace greenloop::offline
