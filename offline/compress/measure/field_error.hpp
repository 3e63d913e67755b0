#pragma once

#include <cstdint>
#include <span>

namespace greenloop::offline {

/// Errors of compressed columns against exact ones, traction form Xi = U diag(area): the measure of James and Pai 2003,
/// section 9.
class FieldError {
 public:
  FieldError() = default;  ///< of all rows

  /// Of the rows that are marked; what `rows` refers to must outlive this.
  explicit FieldError(std::span<const std::uint8_t> rows) : rows_(rows) {}

  /// Adds a column; `found`, `exact`: blocks of 9, 3 c + r, m/N; `area` [m^2] of the column's node. Returns its share
  /// of worst_column.
  double add(std::span<const double> found, const double* exact, double area);

  /// ||Xi^ - Xi||_F / ||Xi||_F over the rows of the columns added; 0 if there are none.
  [[nodiscard]] double rms() const;

  /// max_j ||Xi^_j - Xi_j||_inf / ||Xi_j||_inf, block-wise Frobenius; Xi_j here: all rows.
  [[nodiscard]] double worst_column() const { return worst_column_; }

 private:
  std::span<const std::uint8_t> rows_;  // empty: all
  double error_energy_ = 0, exact_energy_ = 0, worst_column_ = 0;
};

}  // namespace greenloop::offline
