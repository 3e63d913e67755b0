#include "offline/compress/model_builder.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <utility>

#include "offline/compress/force_error.hpp"
#include "offline/compress/hierarchy.hpp"
#include "offline/compress/lifted_linear.hpp"
#include "offline/compress/model_tables.hpp"
#include "offline/compress/search.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t sample_size = 128;    // columns the search works on
constexpr std::size_t stream_columns = 64;  // columns read at a time
constexpr std::array curve_epsilons = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8};

void require_fit(const CompressionInput& input) {
  const std::size_t count = input.mesh.positions.size();
  if (input.column_nodes.empty()) {
    throw std::invalid_argument("compression: column_nodes is empty; at least one free node must be touchable");
  }
  if (input.mesh.vertex_end.size() > layout::max_levels) {
    throw std::invalid_argument("compression: the mesh has " + std::to_string(input.mesh.vertex_end.size()) +
                                " levels; a model holds at most " + std::to_string(layout::max_levels));
  }
  if (!(input.accuracy.rms > 0) || !(input.accuracy.worst_column > 0)) {
    throw std::invalid_argument("compression: accuracy rms = " + std::to_string(input.accuracy.rms) +
                                ", worst_column = " + std::to_string(input.accuracy.worst_column) +
                                "; both must be positive");
  }
  std::size_t touchable = 0;
  for (const auto flag : input.flags) {
    const bool free = (flag & layout::node_fixed) == 0;
    touchable += free && (flag & layout::node_touchable) != 0 ? 1 : 0;
  }
  for (const std::size_t node : input.column_nodes) {
    if (node < count && (input.flags[node] & layout::node_domain) == 0) {
      throw std::invalid_argument("compression: column node " + std::to_string(node) + " is not a domain node");
    }
  }
  if (touchable != input.column_nodes.size()) {
    throw std::invalid_argument("compression: " + std::to_string(input.column_nodes.size()) + " exact columns for " +
                                std::to_string(touchable) + " free touchable nodes; give one column each");
  }
}

/// The constraint levels that exist: those from `coarsest` on with a column.
std::vector<ConstraintLevel> constraint_levels(const CompressionInput& input) {
  const auto finest = static_cast<std::uint32_t>(input.mesh.finest_level());
  if (input.facts.coarsest_constraint_level > finest) {
    throw std::invalid_argument("compression: coarsest_constraint_level is " +
                                std::to_string(input.facts.coarsest_constraint_level) +
                                "; the mesh's finest level is " + std::to_string(finest));
  }
  std::vector<ConstraintLevel> levels;
  for (auto c = input.facts.coarsest_constraint_level; c <= finest; ++c) {
    auto level = constraint_level(input.mesh, input.area, input.column_nodes, c);
    if (!level.columns.empty()) levels.push_back(std::move(level));
  }
  return levels;
}

/// One pass over the exact columns for everything but their own coding.
std::vector<CoarseColumns> gather(const CompressionInput& input, const std::vector<ConstraintLevel>& levels,
                                  std::size_t rows, ContactPatches& patches, const Progress& progress) {
  std::vector<CoarseColumns> coarse;
  for (std::size_t i = 0; i + 1 < levels.size(); ++i) coarse.emplace_back(levels[i], rows);
  const std::size_t total = input.column_nodes.size();
  for (std::size_t first = 0; first < total; first += stream_columns) {
    const std::size_t count = std::min(stream_columns, total - first);
    const Eigen::MatrixXd block = input.columns(first, count);
    if (block.rows() != static_cast<Eigen::Index>(3 * rows) || block.cols() != static_cast<Eigen::Index>(3 * count) ||
        !block.allFinite()) {
      throw std::invalid_argument("compression: exact columns " + std::to_string(first) + " to " +
                                  std::to_string(first + count - 1) + " are not " + std::to_string(3 * rows) + " x " +
                                  std::to_string(3 * count) + " finite numbers");
    }
    for (auto& columns : coarse) columns.add(block, first);
    patches.add(block, first);
    progress(static_cast<double>(first + count) / static_cast<double>(total), "gather coarse columns");
  }
  return coarse;
}

std::vector<CurvePoint> speed_against_error(ColumnCoder& coder, const std::vector<TransformedColumn>& sample,
                                            std::size_t columns, Encoding encoding) {
  std::vector<CurvePoint> curve;
  const double scale = static_cast<double>(columns) / static_cast<double>(sample.size());
  for (const double epsilon : curve_epsilons) {
    encoding.epsilon = epsilon;
    const Tally tally = coder.measure(sample, encoding);
    const double blocks = scale * static_cast<double>(tally.blocks);
    curve.push_back(
        {.epsilon = epsilon,
         .kept_blocks = blocks,
         .bytes = scale * static_cast<double>(tally.bytes),
         .rms_error = tally.rms(),
         .worst_column_error = tally.worst_column,
         .sum_work = static_cast<double>(LiftedLinear::components) * blocks / static_cast<double>(columns)});
  }
  return curve;
}

ConstraintLevelReport report_level(const ConstraintLevel& level, const CompressedLevel& compressed, std::size_t rows,
                                   double force_error) {
  return {.level = level.level,
          .epsilon = compressed.encoding.epsilon,
          .value_bytes = compressed.encoding.value_bytes,
          .columns = compressed.tally.columns,
          .tightened = compressed.tightened,
          .kept_blocks = compressed.tally.blocks,
          .dense_blocks = compressed.tally.columns * rows,
          .bytes = compressed.tally.bytes,
          .rms_error = compressed.tally.rms(),
          .worst_column_error = compressed.tally.worst_column,
          .force_error = force_error};
}

void store_level(ModelData& model, const SemiRegularMesh& mesh, const ConstraintLevel& level,
                 CompressedLevel compressed, const ConstraintLevelReport& report) {
  auto& data = model.levels[level.level];
  data.counts.rms_error = static_cast<float>(report.rms_error);
  data.counts.worst_column_error = static_cast<float>(report.worst_column_error);
  // a model file holds finite numbers only
  const double largest = static_cast<double>(std::numeric_limits<float>::max());
  data.counts.force_error = static_cast<float>(std::min(report.force_error, largest));
  data.columns = level.columns;
  data.blocks = std::move(compressed.blocks);
  std::size_t begin = 0;
  for (const std::size_t end : mesh.vertex_end) {
    data.representatives.emplace_back(level.representatives.begin() + static_cast<std::ptrdiff_t>(begin),
                                      level.representatives.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
  }
}

}  // namespace

BuiltModel build_model(const CompressionInput& input, const Progress& progress) {
  const LiftedLinear wavelet(input.mesh, input.flags, input.area);
  require_fit(input);
  const auto levels = constraint_levels(input);
  const std::size_t rows = wavelet.rows();
  const double stages = 1.0 + static_cast<double>(levels.size());
  double stage = 0;
  const Progress within = [&](double fraction, std::string_view name) {
    if (progress) progress((stage + fraction) / stages, name);
  };

  ContactPatches patches(input.mesh, input.column_nodes, wavelet);
  const auto coarse = gather(input, levels, rows, patches, within);

  BuiltModel built{describe_mesh(input.mesh, input.flags, input.area, wavelet, input.facts), {}};
  built.model.provenance = input.provenance;
  built.report.dense_bytes = 36 * rows * input.column_nodes.size();
  ColumnCoder coder(wavelet);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    stage += 1;
    const bool finest = i + 1 == levels.size();
    const ColumnSource source = finest ? input.columns : coarse[i].source();
    const auto sample = sample_columns(wavelet, levels[i], source, sample_size);
    auto compressed = compress_level(coder, levels[i], source, sample, input.accuracy, within);
    const double force_error = patches.worst_force_error(wavelet, levels[i], compressed);
    if (finest) {
      built.report.curve = speed_against_error(coder, sample, levels[i].columns.size(), compressed.encoding);
      built.report.curve_columns = sample.size();
      built.model.info.epsilon = compressed.encoding.epsilon;
    }
    built.report.levels.push_back(report_level(levels[i], compressed, rows, force_error));
    store_level(built.model, input.mesh, levels[i], std::move(compressed), built.report.levels.back());
  }
  built.model.info.coarsest_constraint_level = levels.front().level;
  return built;
}

}  // namespace greenloop::offline
