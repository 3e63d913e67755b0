#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "offline/compress/compressed_compliance.hpp"
#include "offline/compress/model_field.hpp"

namespace greenloop::offline {

/// What field columns leave out (formats/layout.hpp).
struct FieldThresholds {
  double spread = 0;  ///< layout::Info::field_threshold
  double peak = 0;    ///< layout::Info::field_peak_threshold
};

/// An exact column to compare with.
struct SampleColumn {
  std::size_t row = 0;
  double area = 0;            ///< m^2
  std::vector<double> exact;  ///< rows blocks of 9
};

/// Sample columns of a compressed compliance as fields would be made of them, to choose thresholds with.
class FieldSample {
 public:
  /// Columns of the finest level; what is not read of them is left out. `columns` must outlive this. Work: that of the
  /// columns.
  FieldSample(const CompressedCompliance& compliance, FieldRows read, const std::vector<SampleColumn>& columns);

  struct Outcome {
    double rms = 0, worst_column = 0;  ///< FieldError of the sample
    std::uint32_t longest = 0;         ///< blocks of a column
  };

  /// What thresholds make of the sample. Work: an inverse transform per column.
  [[nodiscard]] Outcome measure(const FieldThresholds& thresholds) const;

  /// The largest thresholds whose errors are at most these; zero if none are. Work: some measurements.
  [[nodiscard]] FieldThresholds choose(double rms, double worst_column) const;

 private:
  [[nodiscard]] std::vector<double> keep(std::size_t column, const FieldThresholds& thresholds,
                                         std::uint32_t& kept) const;

  struct Column {
    std::vector<double> coefficients;  // 9 per row
    double spread_norm = 0, own = 0;
  };
  const SurfaceWavelet& wavelet_;
  FieldRows read_;
  const std::vector<SampleColumn>& exact_;
  std::vector<double> level_weight_;  // by row: 2^-level
  std::vector<Column> columns_;
};

}  // namespace greenloop::offline
