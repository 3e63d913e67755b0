#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/layout.hpp"
#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/measure/field_size.hpp"
#include "offline/compress/measure/pattern_errors.hpp"
#include "offline/compress/search/encoding_search.hpp"
#include "offline/compress/wavelet/exact_columns.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// An exact compliance and what is asked of its compressed model. The referenced objects must outlive build_model.
struct CompressionInput {
  const SemiRegularMesh& mesh;                   ///< ordered by order_nodes
  const std::vector<std::uint32_t>& flags;       ///< layout::NodeFlag per node, closed by mark_domain
  const std::vector<double>& area;               ///< m^2 per node
  const std::vector<std::size_t>& column_nodes;  ///< nodes with an exact column: the domain nodes, increasing
  ExactColumns columns;                          ///< their columns; rows are the domain nodes in node order
  Accuracy accuracy;
  layout::Wavelet wavelet = layout::Wavelet::lifted_linear;
  layout::Info facts{};    ///< from scene and solver: young, poisson, store_asymmetry, rate, max_contacts, step_work,
                           ///< coarsest_constraint_level; the rest is filled in
  std::string provenance;  ///< JSON text
  LevelWork step_work;     ///< may be empty
};

/// One constraint level: the model cut off after it.
struct ConstraintLevelReport {
  std::uint32_t level = 0;
  std::size_t nodes = 0, kept_blocks = 0, dense_blocks = 0;
  double rms_error = 0, worst_column_error = 0, patch_force_error = 0;
  double field_rms_error = 0, field_column_error = 0;  ///< the same at the rows that are read
  FieldSize field;
  std::vector<PatternErrors> patterns;  ///< of the complete model's answers at the level
};

/// What a wavelet made of a body or a sample of it.
struct WaveletTrial {
  layout::Wavelet wavelet = layout::Wavelet::lifted_linear;
  std::size_t nodes = 0;  ///< it was measured on
  Trial trial;            ///< the model; of 0 bytes if none meets the accuracy
};

struct CompressionReport {
  Encoding encoding;
  double lambda_min = 0;                      ///< m/N, certified
  std::size_t patches = 0;                    ///< patches that patch_force_error was measured on
  std::vector<ConstraintLevelReport> levels;  ///< coarse to fine
  std::vector<double> cut_errors;             ///< layout::Level::cut_error of every mesh level
  std::vector<Trial> trials;                  ///< every encoding that was tried, the chosen one last
  std::vector<Trial> frontier;                ///< by decreasing threshold, one each, on every level
  std::vector<WaveletTrial> wavelets;         ///< compared to choose one; empty if it was given
  std::size_t dense_bytes = 0;                ///< float32, 36 bytes per pair of domain nodes
};

struct BuiltModel {
  ModelData model;
  CompressionReport report;
};

/// Compresses the exact compliance into a model that meets `accuracy`, with every constraint level from
/// facts.coarsest_constraint_level on, and measures its answers to contact_patterns on each. Streams the exact columns
/// three times: to transform them, to gather the patterns' fields, to measure all of them; with Equilibrated wavelets
/// those of all levels but the finest once more, before. Memory: a quarter of the
/// dense matrix in single precision besides the result. Deterministic. Throws std::invalid_argument if the input does
/// not fit together, std::runtime_error if the accuracy cannot be met or the result is not positive definite. Offline
/// only.
[[nodiscard]] BuiltModel build_model(const CompressionInput& input, const Progress& progress);

/// What build_model's model comes to, the last of its report's trials, without making the rest of the report. Work:
/// most of build_model's. Throws as it does. Offline only.
[[nodiscard]] Trial chosen_trial(const CompressionInput& input);

}  // namespace greenloop::offline
