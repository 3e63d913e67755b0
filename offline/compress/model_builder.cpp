#include "offline/compress/model_builder.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "offline/compress/certificate.hpp"
#include "offline/compress/exact_sample.hpp"
#include "offline/compress/field_error.hpp"
#include "offline/compress/model_tables.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t search_patches = 16;  // the worst ones, which encodings are tried with
constexpr double ranking_threshold = 0.005;
constexpr std::size_t stream_columns = 64;  // read at a time
constexpr double first_floor = 0.0005, least_floor = 1e-5;
constexpr double field_safety = 0.95;      // of the field's RMS error, searched on a sample
constexpr int field_rounds = 40;           // of weighing columns and measurement
constexpr int rounds = 6;                  // of search and measurement per transform
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

// errors of one level against its exact compliance
ConstraintLevelReport measure_coarse(const CompressionInput& input, const LinearWavelet& wavelet,
                                     const WaveletCompliance& exact, const CompressedCompliance& compressed,
                                     std::size_t level) {
  ContactPatches patches(row_positions(input.mesh, wavelet, level), ExactSample::most_patches);
  FieldError error;
  const std::size_t rows = wavelet.row_end(level);
  Eigen::MatrixXd blocks(3 * rows, 3);
  for (std::size_t j = 0; j < rows; ++j) {
    const auto column = exact_column(wavelet, exact, level, j);
    for (std::size_t i = 0; i < rows; ++i) {
      blocks.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = Eigen::Map<const Eigen::Matrix3d>(column.data() + 9 * i);
    }
    patches.add(blocks, j);
    error.add(compressed, level, j, column.data(), wavelet.integrals(level)[j]);
  }
  return {.level = static_cast<std::uint32_t>(level),
          .nodes = rows,
          .rms_error = error.rms(),
          .worst_column_error = error.worst_column(),
          .patch_force_error = patches.worst_force_error(compressed, level)};
}

// errors over all exact columns
struct ColumnErrors {
  FieldError error;
  std::vector<PoorColumn> poor;  // beyond the accuracy asked for
};

// of the finest level, for each of several compressed compliances
std::vector<ColumnErrors> measure_finest(const CompressionInput& input,
                                         std::initializer_list<const CompressedCompliance*> compressed,
                                         const Progress& progress) {
  std::vector<ColumnErrors> errors(compressed.size());
  const std::size_t rows = input.column_nodes.size();
  for (std::size_t first = 0; first < rows; first += stream_columns) {
    const std::size_t count = std::min(stream_columns, rows - first);
    const Eigen::MatrixXd block = input.columns(first, count);
    for (std::size_t j = 0; j < count; ++j) {
      const auto exact = blocks_of(block, j);
      const double area = input.area[input.column_nodes[first + j]];
      auto one = errors.begin();
      for (const auto* compliance : compressed) {
        const double error = one->error.add(*compliance, compliance->finest(), first + j, exact.data(), area);
        const double excess = error / input.accuracy.worst_column;
        if (excess > 1) one->poor.push_back({.row = first + j, .excess = excess});
        ++one;
      }
    }
    progress(static_cast<double>(first + count) / static_cast<double>(rows), "measure all columns");
  }
  return errors;
}

void add_patches(const std::vector<std::size_t>& more, std::vector<std::size_t>& patches) {
  patches.insert(patches.end(), more.begin(), more.end());
  std::sort(patches.begin(), patches.end());
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
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
  model.info.lambda_min = report.lambda_min;
}

[[noreturn]] void unreachable_accuracy(const Accuracy& wanted, const Trial& best) {
  throw std::runtime_error(
      "compression: rms = " + std::to_string(wanted.rms) + ", worst_column = " + std::to_string(wanted.worst_column) +
      ", patch_force = " + std::to_string(wanted.patch_force) + " cannot be met; the best found was " +
      std::to_string(best.rms) + ", " + std::to_string(best.worst_column) + ", " + std::to_string(best.patch_force) +
      ": ask for larger errors");
}

// An encoding of the whole model, measured on everything.
struct Measured {
  Trial trial;
  FieldError field;
  bool field_meets = false;  // the accuracy asked for
  std::vector<std::size_t> worst_patches;
  double least_eigenvalue = 0;  // m/N, estimated; only of a trial that meets the accuracy
};

// One build. The columns are transformed again with a lower floor if no encoding of the one at hand is accurate enough.
class Build {
 public:
  Build(const CompressionInput& input, const Progress& progress)
      : input_(input),
        progress_(progress),
        wavelet_(input.mesh, input.flags, input.area, input.lifted),
        sample_(checked(input, wavelet_).mesh, wavelet_, input.area) {
    model_ = describe_mesh(input.mesh, input.flags, input.area, wavelet_, input.facts);
    model_.provenance = input.provenance;
    add_representatives(input.mesh, input.flags, model_);
    report_.dense_bytes = 36 * wavelet_.rows() * wavelet_.rows();
  }

  [[nodiscard]] BuiltModel run() {
    for (double floor = first_floor; !meets_with(floor); floor /= 4) {
      if (floor <= least_floor) unreachable_accuracy(input_.accuracy, closest_);
    }
    store_errors(report_, model_);
    if (progress_) progress_(1.0, "done");
    return {std::move(model_), std::move(report_)};
  }

 private:
  static const CompressionInput& checked(const CompressionInput& input, const LinearWavelet& wavelet) {
    require_fit(input, wavelet);
    return input;
  }

  // Reports on a part of the work; what is done again does not lead back.
  [[nodiscard]] Progress part(double begin, double end) {
    return [this, begin, end](double fraction, std::string_view stage) {
      done_ = std::max(done_, begin + (end - begin) * fraction);
      if (progress_) progress_(done_, stage);
    };
  }

  [[nodiscard]] WaveletCompliance transform(double floor) {
    const ColumnSource columns = [&](std::size_t first, std::size_t count) {
      Eigen::MatrixXd block = input_.columns(first, count);
      const bool fits = block.rows() == static_cast<Eigen::Index>(3 * wavelet_.rows());
      if (floor == first_floor && fits) sample_.add(block, first);
      return block;
    };
    return transform_compliance(wavelet_, columns, floor, part(0, 0.3));
  }

  // searches and measures until an encoding meets the accuracy on everything; false: none does with this floor
  [[nodiscard]] bool meets_with(double floor) {
    const WaveletCompliance compliance = transform(floor);
    const TrialBench bench{compliance, model_, sample_.columns(), input_.step_work};
    std::vector<std::size_t> searched = worst_patches(bench, sample_.patches(), search_patches, ranking_threshold);
    Accuracy aim = input_.accuracy;
    aim.patch_force *= safety;
    for (int round = 0; round < rounds; ++round) {
      Trial chosen =
          search_encoding(bench, sample_.patches().choose(searched), aim, floor, report_.trials, part(0.3, 0.6));
      closest_ = chosen;
      if (!chosen.meets(aim)) return false;
      chosen.encoding =
          search_field_threshold(bench, field_safety * input_.accuracy.rms, chosen.encoding, part(0.6, 0.7));
      Measured measured = measure(compliance, chosen);
      if (measured.trial.meets(input_.accuracy) && measured.field_meets && measured.least_eigenvalue > 0) {
        const EncodedModel encoded(model_);
        measured.trial.bytes = encoded.bytes.size();
        describe(measured);
        describe_levels(compliance, encoded.view, measured.trial);
        return true;
      }
      closest_ = measured.trial;
      add_patches(measured.worst_patches, searched);
      tighten(aim, measured);
    }
    return false;
  }

  [[nodiscard]] Measured measure(const WaveletCompliance& compliance, const Trial& chosen) {
    Measured measured{.trial = chosen, .field = {}, .worst_patches = {}};
    encode_couplings(compliance, chosen.encoding, model_);
    const EncodedModel encoded(model_);
    const CompressedCompliance all(encoded.view, layout::layers), field(encoded.view, layout::field_layers);
    const auto errors = measure_finest(input_, {&all, &field}, part(0.7, 0.75));
    measured.trial.rms = errors[0].error.rms();
    measured.trial.worst_column = errors[0].error.worst_column();
    const auto patches = sample_.patches().force_errors(all, wavelet_.finest());
    measured.trial.patch_force = patches.front().force;
    for (std::size_t p = 0; p < std::min(search_patches, patches.size()); ++p) {
      measured.worst_patches.push_back(patches[p].patch);
    }
    if (measured.trial.meets(input_.accuracy)) {
      measured.least_eigenvalue = estimate_least_eigenvalue(all, part(0.75, 0.85));
      improve_field(compliance, errors[1], measured);
    }
    return measured;
  }

  [[nodiscard]] bool meets(const ColumnErrors& errors) const {
    return errors.error.rms() <= input_.accuracy.rms && errors.poor.empty();
  }

  // Where the sample promised too much of the field, more couplings make it, first those of the poor columns, in the
  // end all, with more digits. The forces do not change by that.
  void improve_field(const WaveletCompliance& compliance, ColumnErrors errors, Measured& measured) {
    Encoding& encoding = measured.trial.encoding;
    for (int round = 0; !meets(errors); ++round) {
      if (encoding.field_threshold == 0 && encoding.fine_field) break;
      if (errors.error.rms() > input_.accuracy.rms) encoding.field_threshold *= 0.8;
      if (round == field_rounds / 2 || encoding.field_threshold == 0) encoding.fine_field = true;
      if (round == field_rounds) encoding.field_threshold = 0;
      weigh_columns(wavelet_, compliance, errors.poor, encoding);
      encode_couplings(compliance, encoding, model_);
      const EncodedModel encoded(model_);
      const CompressedCompliance field(encoded.view, layout::field_layers);
      errors = measure_finest(input_, {&field}, part(0.85, 0.9))[0];
    }
    measured.field = errors.error;
    measured.field_meets = meets(errors);
  }

  // asks the next search for as much less as this one's choice fell short by; patches it has learned of itself
  void tighten(Accuracy& aim, const Measured& measured) const {
    const Trial& trial = measured.trial;
    const Accuracy& wanted = input_.accuracy;
    if (trial.meets(wanted)) {  // but it is not positive definite, or its field falls short
      aim.patch_force *= 0.5;
      return;
    }
    aim.rms *= std::min(1.0, 0.98 * wanted.rms / trial.rms);
    aim.worst_column *= std::min(1.0, 0.98 * wanted.worst_column / trial.worst_column);
  }

  void describe(const Measured& measured) {
    report_.encoding = measured.trial.encoding;
    report_.trials.push_back(measured.trial);
    report_.lambda_min = certificate_share * measured.least_eigenvalue;
    report_.field_rms_error = measured.field.rms();
    report_.field_column_error = measured.field.worst_column();
    report_.patches = sample_.patches().size();
  }

  void describe_levels(const WaveletCompliance& compliance, const ModelView& view, const Trial& finest) {
    const CompressedCompliance all(view, layout::layers);
    for (std::size_t level = model_.info.coarsest_constraint_level; level < wavelet_.finest(); ++level) {
      report_.levels.push_back(measure_coarse(input_, wavelet_, compliance, all, level));
    }
    report_.levels.push_back({.level = static_cast<std::uint32_t>(wavelet_.finest()),
                              .nodes = wavelet_.rows(),
                              .rms_error = finest.rms,
                              .worst_column_error = finest.worst_column,
                              .patch_force_error = finest.patch_force});
    for (auto& level : report_.levels) {
      level.kept_blocks = view.level[level.level].counts->kept_blocks;
      level.dense_blocks = view.level[level.level].counts->dense_blocks;
    }
  }

  const CompressionInput& input_;
  const Progress& progress_;
  LinearWavelet wavelet_;
  ExactSample sample_;
  ModelData model_;
  CompressionReport report_;
  Trial closest_;  // the last that failed
  double done_ = 0;
};

}  // namespace

BuiltModel build_model(const CompressionInput& input, const Progress& progress) { return Build(input, progress).run(); }

}  // namespace greenloop::offline
