#include "offline/compress/measure/field_error.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop::offline {

double FieldError::add(std::span<const double> found, const double* exact, double area) {
  double error = 0, norm = 0, largest_error = 0, largest = 0;
  for (std::size_t i = 0; i < found.size(); i += 9) {
    double block_error = 0, block_norm = 0;
    for (std::size_t k = i; k < i + 9; ++k) {
      block_error += (found[k] - exact[k]) * (found[k] - exact[k]);
      block_norm += exact[k] * exact[k];
    }
    largest = std::max(largest, block_norm);
    if (!rows_.empty() && rows_[i / 9] == 0) continue;
    error += block_error;
    norm += block_norm;
    largest_error = std::max(largest_error, block_error);
  }
  error_energy_ += area * area * error;
  exact_energy_ += area * area * norm;
  const double column_error = std::sqrt(largest_error / largest);
  worst_column_ = std::max(worst_column_, column_error);
  return column_error;
}

double FieldError::rms() const { return exact_energy_ > 0 ? std::sqrt(error_energy_ / exact_energy_) : 0; }

}  // namespace greenloop::offline
