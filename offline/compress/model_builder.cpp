#include "offline/compress/model_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "formats/aligned_bytes.hpp"
#include "formats/verify.hpp"
#include "offline/compress/certificate.hpp"
#include "offline/compress/field_error.hpp"
#include "offline/compress/model_tables.hpp"
#include "offline/compress/representatives.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t most_patches = 160;   // measured
constexpr std::size_t search_patches = 16;  // of them, the worst ones are searched with
constexpr std::size_t sample_columns = 64;
constexpr std::size_t stream_columns = 64;  // read at a time
constexpr double first_floor = 0.0005, least_floor = 1e-5;
constexpr double first_threshold = 0.005;  // that picks the worst patches
constexpr double safety = 0.97;            // of the patches' error, which the search sees only a part of
constexpr double certificate_share = 0.5;  // of the least eigenvalue's estimate

void require_fit(const CompressionInput& input, const LinearWavelet& wavelet) {
  if (input.mesh.vertex_end.size() > layout::max_levels) {
    throw std::invalid_argument("compression: the mesh has " + std::to_string(input.mesh.vertex_end.size()) +
                                " levels; a model holds at most " + std::to_string(layout::max_levels));
  }
  const auto& [rms, column, force] = input.accuracy;
  if (!(rms > 0) || !(column > 0) || !(force > 0)) {
    throw std::invalid_argument("compression: accuracy rms = " + std::to_string(rms) +
                                ", worst_column = " + std::to_string(column) +
                                ", patch_force = " + std::to_string(force) + "; all must be positive");
  }
  if (wavelet.rows() == 0) throw std::invalid_argument("compression: no node is free and needed");
  if (input.column_nodes != wavelet.nodes()) {
    throw std::invalid_argument("compression: " + std::to_string(input.column_nodes.size()) + " exact columns for " +
                                std::to_string(wavelet.rows()) + " domain nodes; give one column each, in node order");
  }
}

std::vector<Eigen::Vector3d> positions(const CompressionInput& input, const LinearWavelet& wavelet, std::size_t level) {
  std::vector<Eigen::Vector3d> result;
  for (std::size_t row = 0; row < wavelet.row_end(level); ++row) {
    result.push_back(input.mesh.positions[wavelet.nodes()[row]]);
  }
  return result;
}

std::vector<double> blocks_of(const Eigen::MatrixXd& columns, std::size_t j) {
  std::vector<double> blocks(3 * static_cast<std::size_t>(columns.rows()));
  for (Eigen::Index i = 0; i < columns.rows() / 3; ++i) {
    Eigen::Map<Eigen::Matrix3d>(blocks.data() + 9 * i) = columns.block<3, 3>(3 * i, static_cast<Eigen::Index>(3 * j));
  }
  return blocks;
}

// What the search and the measurement compare with: gathered while the columns stream by the first time.
struct Reference {
  ContactPatches patches;
  std::vector<SampleColumn> columns;

  Reference(const CompressionInput& input, const LinearWavelet& wavelet)
      : patches(positions(input, wavelet, wavelet.finest()), most_patches), wanted_(sampled_rows(wavelet.rows())) {
    for (const std::size_t row : wanted_) {
      columns.push_back({.row = row, .area = input.area[wavelet.nodes()[row]], .exact = {}});
    }
  }

  void add(const Eigen::MatrixXd& block, std::size_t first) {
    patches.add(block, first);
    const std::size_t end = first + static_cast<std::size_t>(block.cols()) / 3;
    for (auto& column : columns) {
      if (column.row >= first && column.row < end) column.exact = blocks_of(block, column.row - first);
    }
  }

 private:
  static std::vector<std::size_t> sampled_rows(std::size_t rows) {
    const std::size_t count = std::min(sample_columns, rows);
    std::vector<std::size_t> sample;
    for (std::size_t i = 0; i < count; ++i) sample.push_back(i * rows / count);
    return sample;
  }
  std::vector<std::size_t> wanted_;
};

AlignedBytes encoded(const ModelData& model, ModelView& view) {
  AlignedBytes bytes(encode(model));
  if (const auto result = verify(bytes.span(), view); !result.ok()) {
    throw std::logic_error(std::string("compression: the model does not verify: ") + result.field);
  }
  return bytes;
}

// errors of one level against its exact compliance
ConstraintLevelReport measure_coarse(const CompressionInput& input, const LinearWavelet& wavelet,
                                     const CompliancePyramid& pyramid, const CompressedCompliance& compressed,
                                     std::size_t level) {
  const DenseCompliance& exact = pyramid.coarse[level];
  ContactPatches patches(positions(input, wavelet, level), most_patches);
  FieldError error;
  Eigen::MatrixXd column(3 * exact.rows(), 3);
  for (std::size_t j = 0; j < exact.rows(); ++j) {
    for (std::size_t i = 0; i < exact.rows(); ++i) {
      column.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = exact.block(i, j);
    }
    patches.add(column, j);
    error.add(compressed, level, j, blocks_of(column, 0).data(), wavelet.integrals(level)[j]);
  }
  return {.level = static_cast<std::uint32_t>(level),
          .nodes = exact.rows(),
          .rms_error = error.rms(),
          .worst_column_error = error.worst_column(),
          .patch_force_error = patches.worst_force_error(compressed, level)};
}

struct FinestErrors {
  FieldError all, strong;
};

// errors of the finest level over all exact columns
FinestErrors measure_finest(const CompressionInput& input, const CompressedCompliance& all,
                            const CompressedCompliance& strong, const Progress& progress) {
  FinestErrors errors;
  const std::size_t rows = input.column_nodes.size(), finest = all.finest();
  for (std::size_t first = 0; first < rows; first += stream_columns) {
    const std::size_t count = std::min(stream_columns, rows - first);
    const Eigen::MatrixXd block = input.columns(first, count);
    for (std::size_t j = 0; j < count; ++j) {
      const auto exact = blocks_of(block, j);
      const double area = input.area[input.column_nodes[first + j]];
      errors.all.add(all, finest, first + j, exact.data(), area);
      errors.strong.add(strong, finest, first + j, exact.data(), area);
    }
    progress(static_cast<double>(first + count) / static_cast<double>(rows), "measure all columns");
  }
  return errors;
}

float stored(double error) { return static_cast<float>(std::min(error, double{std::numeric_limits<float>::max()})); }

void store_errors(const CompressionReport& report, ModelData& model) {
  for (const auto& level : report.levels) {
    auto& counts = model.levels[level.level].counts;
    counts.rms_error = counts.field_rms_error = stored(level.rms_error);
    counts.worst_column_error = counts.field_column_error = stored(level.worst_column_error);
    counts.patch_force_error = stored(level.patch_force_error);
  }
  auto& finest = model.levels.back().counts;
  finest.field_rms_error = stored(report.field_rms_error);
  finest.field_column_error = stored(report.field_column_error);
  model.info.threshold = report.encoding.threshold;
  model.info.field_layers = report.field_layers;
  model.info.lambda_min = report.lambda_min;
}

std::size_t add_representatives(const CompressionInput& input, ModelData& model) {
  const auto& touchable = input.flags;
  auto first = static_cast<std::size_t>(input.facts.coarsest_constraint_level);
  for (std::size_t level = first; level < model.levels.size(); ++level) {
    const auto all = representatives(input.mesh, touchable, level);
    const bool none = std::all_of(all.begin(), all.end(), [](std::uint32_t r) { return r == layout::none; });
    if (none) {
      first = level + 1;
      continue;
    }
    std::size_t begin = 0;
    for (const std::size_t end : input.mesh.vertex_end) {
      model.levels[level].representatives.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                                       all.begin() + static_cast<std::ptrdiff_t>(end));
      begin = end;
    }
  }
  if (first >= model.levels.size()) {
    throw std::invalid_argument("compression: no node is both free and touchable on constraint level " +
                                std::to_string(input.facts.coarsest_constraint_level) + " or finer");
  }
  return first;
}

[[noreturn]] void unreachable_accuracy(const Accuracy& wanted, const Trial& best) {
  throw std::runtime_error(
      "compression: rms = " + std::to_string(wanted.rms) + ", worst_column = " + std::to_string(wanted.worst_column) +
      ", patch_force = " + std::to_string(wanted.patch_force) + " cannot be met; the best found was " +
      std::to_string(best.rms) + ", " + std::to_string(best.worst_column) + ", " + std::to_string(best.patch_force) +
      ": ask for larger errors");
}

}  // namespace

BuiltModel build_model(const CompressionInput& input, const Progress& progress) {
  const LinearWavelet wavelet(input.mesh, input.flags, input.area, input.lifted);
  require_fit(input, wavelet);
  BuiltModel built{describe_mesh(input.mesh, input.flags, input.area, wavelet, input.facts), {}};
  auto& [model, report] = built;
  model.provenance = input.provenance;
  model.info.field_layers = all_layers;
  model.info.coarsest_constraint_level = static_cast<std::uint32_t>(add_representatives(input, model));
  report.dense_bytes = 36 * wavelet.rows() * wavelet.rows();

  const auto part = [&](double begin, double end) -> Progress {
    return [&progress, begin, end](double fraction, std::string_view stage) {
      if (progress) progress(begin + (end - begin) * fraction, stage);
    };
  };
  Reference reference(input, wavelet);
  double floor = first_floor;
  for (;; floor /= 4) {
    const CompliancePyramid pyramid = build_pyramid(
        wavelet,
        [&](std::size_t first, std::size_t count) {
          Eigen::MatrixXd block = input.columns(first, count);
          if (floor == first_floor && block.rows() == static_cast<Eigen::Index>(3 * wavelet.rows())) {
            reference.add(block, first);
          }
          return block;
        },
        floor, part(0, 0.3));
    const TrialBench bench{pyramid, model, reference.columns, input.step_work};
    ModelView view;
    ModelData first_guess = model;
    const double guess = std::max(first_threshold, floor);
    encode_couplings(pyramid, {.threshold = guess, .quantum = 0.5 * guess}, first_guess);
    const AlignedBytes guessed = encoded(first_guess, view);
    ContactPatches searched =
        reference.patches.worst_of(CompressedCompliance(view, all_layers), wavelet.finest(), search_patches);

    Accuracy aim = input.accuracy;
    aim.patch_force *= safety;
    for (int round = 0; round < 4; ++round) {
      Trial chosen = search_encoding(bench, searched, aim, floor, report.trials, part(0.3, 0.6));
      if (!chosen.meets(aim)) {
        if (floor > least_floor) break;
        unreachable_accuracy(input.accuracy, chosen);
      }
      Accuracy field = input.accuracy;
      field.rms *= 0.95;  // of the sample; all columns are measured below
      field.worst_column *= 0.7;
      chosen.encoding = search_field_threshold(bench, field, chosen.encoding, part(0.6, 0.7));
      encode_couplings(pyramid, chosen.encoding, model);
      const AlignedBytes bytes = encoded(model, view);
      const CompressedCompliance all(view, all_layers), strong(view, 1);
      const FinestErrors errors = measure_finest(input, all, strong, part(0.7, 0.8));
      const double force = reference.patches.worst_force_error(all, wavelet.finest());
      const Trial measured{.encoding = chosen.encoding,
                           .bytes = bytes.span().size(),
                           .blocks = chosen.blocks,
                           .rms = errors.all.rms(),
                           .worst_column = errors.all.worst_column(),
                           .patch_force = force,
                           .step_work = chosen.step_work};
      if (!measured.meets(input.accuracy)) {
        aim.rms *= std::min(1.0, 0.98 * input.accuracy.rms / measured.rms);
        aim.worst_column *= std::min(1.0, 0.98 * input.accuracy.worst_column / measured.worst_column);
        aim.patch_force *= std::min(1.0, 0.97 * input.accuracy.patch_force / measured.patch_force);
        continue;
      }
      const double least = estimate_least_eigenvalue(all, part(0.8, 0.9));
      if (!(least > 0)) {
        aim.patch_force *= 0.5;
        continue;
      }
      report.encoding = chosen.encoding;
      report.trials.push_back(measured);
      report.lambda_min = certificate_share * least;
      const bool strong_suffices =
          errors.strong.rms() <= input.accuracy.rms && errors.strong.worst_column() <= input.accuracy.worst_column;
      report.field_layers = strong_suffices ? 1 : all_layers;
      const FieldError& field_error = strong_suffices ? errors.strong : errors.all;
      report.field_rms_error = field_error.rms();
      report.field_column_error = field_error.worst_column();
      report.patches = reference.patches.size();
      for (std::size_t level = model.info.coarsest_constraint_level; level < wavelet.finest(); ++level) {
        report.levels.push_back(measure_coarse(input, wavelet, pyramid, all, level));
      }
      report.levels.push_back({.level = static_cast<std::uint32_t>(wavelet.finest()),
                               .nodes = wavelet.rows(),
                               .rms_error = measured.rms,
                               .worst_column_error = measured.worst_column,
                               .patch_force_error = measured.patch_force});
      for (auto& level : report.levels) {
        level.kept_blocks = view.level[level.level].counts->kept_blocks;
        level.dense_blocks = view.level[level.level].counts->dense_blocks;
      }
      store_errors(report, model);
      return built;
    }
    if (floor <= least_floor) unreachable_accuracy(input.accuracy, report.trials.back());
  }
}

}  // namespace greenloop::offline
