#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/exchange/semi_regular_mesh.hpp"
#include "formats/layout.hpp"
#include "formats/writer.hpp"
#include "offline/compress/level_compression.hpp"

namespace greenloop::offline {

/// An exact compliance and what is asked of its compressed model. The referenced objects must outlive build_model.
struct CompressionInput {
  const SemiRegularMesh& mesh;                   ///< ordered by order_nodes
  const std::vector<std::uint32_t>& flags;       ///< layout::NodeFlag per node, closed by mark_domain
  const std::vector<double>& area;               ///< m^2 per node
  const std::vector<std::size_t>& column_nodes;  ///< nodes with an exact column: all free touchable ones, increasing
  ColumnSource columns;                          ///< their columns; rows are the domain nodes in node order
  Accuracy accuracy;                             ///< to be met on every constraint level by itself
  layout::Info facts{};    ///< from scene and solver: young, poisson, store_asymmetry, rate, max_contacts, step_work,
                           ///< coarsest_constraint_level; the rest is filled in
  std::string provenance;  ///< JSON text
};

/// How one constraint level came out.
struct ConstraintLevelReport {
  std::uint32_t level = 0;
  double epsilon = 0;
  std::vector<std::uint32_t> value_bytes;  ///< per row level
  std::size_t columns = 0, tightened = 0, kept_blocks = 0, dense_blocks = 0, bytes = 0;
  double rms_error = 0, worst_column_error = 0;  ///< over all columns
  double force_error = 0;
};

/// One point of the curve speed against error, finest constraint level, measured on sampled columns without lowering
/// any column's threshold; blocks and bytes are scaled up to all columns.
struct CurvePoint {
  double epsilon = 0;
  double kept_blocks = 0, bytes = 0;
  double rms_error = 0, worst_column_error = 0;
  double sum_work = 0;  ///< multiply-adds to sum one column of mean length, 9 per block
};

struct CompressionReport {
  std::vector<ConstraintLevelReport> levels;  ///< coarse to fine
  std::vector<CurvePoint> curve;
  std::size_t curve_columns = 0;  ///< columns the curve was measured on
  std::size_t dense_bytes = 0;    ///< float32, 36 bytes per exact column and domain node
};

struct BuiltModel {
  ModelData model;
  CompressionReport report;
};

/// Compresses the exact compliance into a model that meets `accuracy`, with every constraint level from
/// facts.coarsest_constraint_level on that has a column. Streams the exact columns once for the coarser levels and up
/// to six times for the finest. Memory: 36 bytes times rows times coarser columns (a third of the dense matrix in
/// single precision) besides the result. Deterministic. Throws std::invalid_argument if the input does not fit
/// together, std::runtime_error if the accuracy cannot be met. Offline only.
[[nodiscard]] BuiltModel build_model(const CompressionInput& input, const Progress& progress);

}  // namespace greenloop::offline
