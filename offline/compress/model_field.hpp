#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/aligned_bytes.hpp"
#include "formats/view.hpp"
#include "offline/compress/surface_wavelet.hpp"
#include "runtime/field_columns.hpp"

namespace greenloop::offline {

/// How many blocks the field columns have that a body of the loop makes of a model, whatever the model says of it.
/// Throws std::runtime_error if a number is not finite. Work: that of FieldColumnMaker::make.
[[nodiscard]] FieldColumnMaker::Counts count_field_columns(const ModelView& view);

/// What fields are read of, 1 for each domain row or coefficient, else 0.
struct FieldRows {
  std::vector<std::uint8_t> nodes;         ///< with layout::node_read
  std::vector<std::uint8_t> coefficients;  ///< that the displacement of such a node depends on
};

/// Of a model's finest level. Linear.
[[nodiscard]] FieldRows read_rows(const ModelView& view);

/// The field columns that a body of the loop makes of a model, bit by bit.
class ModelField {
 public:
  /// Whatever the model says of their number. The view may go. Throws std::runtime_error if a number is not
  /// finite. Work: that of FieldColumnMaker::make, twice.
  explicit ModelField(const ModelView& view);

  [[nodiscard]] const FieldColumnMaker::Counts& counts() const { return counts_; }

  /// Blocks of the column of row j of K(level); 0 if that stands for no touchable node or a force on it moves nothing.
  [[nodiscard]] std::uint64_t length(std::size_t level, std::size_t j) const {
    const std::uint32_t column = make_column(static_cast<std::uint32_t>(level), static_cast<std::uint32_t>(j));
    return column_blocks(columns_, column, columns_.levels - 1);
  }
  [[nodiscard]] bool has_column(std::size_t level, std::size_t j) const { return length(level, j) > 0; }

  /// Displacements by a unit force on its node: domain rows blocks of 9, 3 c + r, m/N. `wavelet`: the model's.
  [[nodiscard]] std::vector<double> column(const SurfaceWavelet& wavelet, std::size_t level, std::size_t j) const;

 private:
  FieldColumnMaker::Counts counts_;
  AlignedBytes tables_memory_, blocks_memory_;
  FieldColumns columns_;
};

}  // namespace greenloop::offline
