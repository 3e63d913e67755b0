#include "offline/compress/model_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "formats/verify.hpp"
#include "formats/write/describe.hpp"
#include "offline/compress/encode/model_tables.hpp"
#include "offline/compress/measure/certificate.hpp"
#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/measure/field_error.hpp"
#include "offline/compress/measure/field_size.hpp"
#include "offline/compress/search/frontier.hpp"
#include "offline/compress/search/pattern_search.hpp"
#include "offline/compress/wavelet/equilibrated_prediction.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t search_patches = 16;  // the worst ones, which encodings are tried with
constexpr double ranking_threshold = 0.005;
constexpr std::size_t stream_columns = 64;  // read at a time
constexpr double first_floor = 0.0005, least_floor = 1e-5;
constexpr int rounds = 6;                  // of search and measurement per transform
constexpr double safety = 0.97;            // of the patches' error, which the search sees only a part of
constexpr double certificate_share = 0.5;  // of the least eigenvalue's estimate
constexpr std::size_t many_rows = 5000;    // where exact fields take room and fewer sites have to do
constexpr std::size_t pattern_sites = 24, few_pattern_sites = 12;

void require_fit(const CompressionInput& input, const SurfaceWavelet& wavelet) {
  if (input.mesh.vertex_end.size() > layout::max_levels) {
    throw std::invalid_argument("compression: the mesh has " + std::to_string(input.mesh.vertex_end.size()) +
                                " levels; a model holds at most " + std::to_string(layout::max_levels));
  }
  const auto& [rms, column, force, field, peak, rough] = input.accuracy;
  if (!(rms > 0) || !(column > 0) || !(force > 0) || !(field > 0) || !(peak > 0) || !(rough > 0)) {
    throw std::invalid_argument("compression: accuracy rms = " + std::to_string(rms) + ", worst_column = " +
                                std::to_string(column) + ", patch_force = " + std::to_string(force) +
                                ", field = " + std::to_string(field) + ", field_peak = " + std::to_string(peak) +
                                ", field_rough = " + std::to_string(rough) + "; all must be positive");
  }
  if (wavelet.rows() == 0) throw std::invalid_argument("compression: no node is free and needed");
  if (input.column_nodes != wavelet.nodes()) {
    throw std::invalid_argument("compression: " + std::to_string(input.column_nodes.size()) + " exact columns for " +
                                std::to_string(wavelet.rows()) + " domain nodes; give one column each, in node order");
  }
}

// 1 for each domain row with layout::node_read, else 0
std::vector<std::uint8_t> read_rows(const ModelView& view) {
  std::vector<std::uint8_t> read;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      read.push_back((level.nodes[i].flags & layout::node_read) != 0 ? 1 : 0);
    }
  }
  return read;
}

// errors of one level, cut off after it, against its exact compliance
ConstraintLevelReport measure_coarse(const CompressionInput& input, const SurfaceWavelet& wavelet,
                                     const WaveletCompliance<3>& exact, const ModelView& cut, std::size_t level) {
  const CompressedCompliance<3> compressed(cut);
  ContactPatches patches(row_positions(input.mesh, wavelet, level), ExactSample::most_patches);
  const auto read = read_rows(cut);
  FieldError error, field_error(read);
  const std::size_t rows = wavelet.row_end(level);
  Eigen::MatrixXd blocks(3 * rows, 3);
  for (std::size_t j = 0; j < rows; ++j) {
    const auto column = exact_column(wavelet, exact, level, j);
    for (std::size_t i = 0; i < rows; ++i) {
      blocks.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = Eigen::Map<const Eigen::Matrix3d>(column.data() + 9 * i);
    }
    patches.add(blocks, j);
    const double area = wavelet.integrals(level)[j];
    const auto found = compressed.column(level, j);
    error.add(found, column.data(), area);
    field_error.add(found, column.data(), area);
  }
  return {.level = static_cast<std::uint32_t>(level),
          .nodes = rows,
          .rms_error = error.rms(),
          .worst_column_error = error.worst_column(),
          .patch_force_error = patches.worst_force_error(compressed, level),
          .field_rms_error = field_error.rms(),
          .field_column_error = field_error.worst_column(),
          .field = field_size(cut),
          .patterns = {}};
}

// calls visit(row, its exact column as blocks, the area of its node) for every column, in order
template <class Visit>
void visit_exact_columns(const CompressionInput& input, const Progress& progress, Visit visit) {
  const std::size_t rows = input.column_nodes.size();
  for (std::size_t first = 0; first < rows; first += stream_columns) {
    const std::size_t count = std::min(stream_columns, rows - first);
    const Eigen::MatrixXd block = input.columns(first, count);
    for (std::size_t j = 0; j < count; ++j) {
      visit(first + j, blocks_of(block, j), input.area[input.column_nodes[first + j]]);
    }
    progress(static_cast<double>(first + count) / static_cast<double>(rows), "measure all columns");
  }
}

void add_patches(const std::vector<std::size_t>& more, std::vector<std::size_t>& patches) {
  patches.insert(patches.end(), more.begin(), more.end());
  std::sort(patches.begin(), patches.end());
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
}

float stored(double error) { return static_cast<float>(std::min(error, double{std::numeric_limits<float>::max()})); }

// room in the file for what is measured last
void reserve_patterns(const ExactContacts& contacts, ModelData& model) {
  std::vector<AnswerError> none;
  for (const auto& site : contacts.sites()) {
    for (const auto kind : site.kinds) none.push_back({.kind = kind, .contacts = site.contacts});
  }
  for (std::size_t level = model.info.coarsest_constraint_level; level < model.levels.size(); ++level) {
    model.levels[level].patterns = pattern_records(summarise(none));
  }
}

// whether something is promised of a pattern
bool is_accurate(const PatternErrors& pattern) {
  return pattern.contacts <= most_accurate_contacts && !layout::is_rough(pattern.kind);
}

double worst_field_error(const std::vector<PatternErrors>& patterns) {
  double worst = 0;
  for (const PatternErrors& pattern : patterns) {
    worst = is_accurate(pattern) ? std::max(worst, pattern.field.worst) : worst;
  }
  return worst;
}

void store_errors(const CompressionReport& report, ModelData& model) {
  for (std::size_t q = 0; q < model.levels.size(); ++q) model.levels[q].counts.cut_error = stored(report.cut_errors[q]);
  for (const auto& level : report.levels) {
    model.levels[level.level].patterns = pattern_records(level.patterns);
    auto& counts = model.levels[level.level].counts;
    counts.rms_error = stored(level.rms_error);
    counts.worst_column_error = stored(level.worst_column_error);
    counts.patch_force_error = stored(level.patch_force_error);
    counts.field_rms_error = stored(level.field_rms_error);
    counts.field_column_error = stored(level.field_column_error);
    for (const PatternErrors& pattern : level.patterns) {
      if (!is_accurate(pattern)) continue;
      counts.field_error = std::max(counts.field_error, stored(pattern.field.worst));
      counts.field_peak = std::max(counts.field_peak, stored(pattern.peak.worst));
      counts.force_error = std::max(counts.force_error, stored(pattern.force.worst));
    }
  }
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

[[noreturn]] void unreachable_field(const Accuracy& wanted, const PatternErrors& best) {
  throw std::runtime_error(
      "compression: field = " + std::to_string(wanted.field) + ", field_peak = " + std::to_string(wanted.field_peak) +
      ", field_rough = " + std::to_string(wanted.field_rough) + " cannot be met; the best found for the pattern `" +
      std::string(pattern_name(static_cast<std::uint32_t>(best.kind))) + "` of " + std::to_string(best.contacts) +
      " contacts was " + std::to_string(best.field.worst) + ", " + std::to_string(best.peak.worst) +
      ": ask for larger errors");
}

// An encoding of the whole model, measured on everything.
struct Measured {
  Trial trial;
  FieldError field;
  std::vector<std::size_t> worst_patches;
  double least_eigenvalue = 0;  // m/N, estimated; only of a trial that meets the accuracy
};

// The encoding that a model is made with, the columns as transformed for it, and the patches it was searched with.
struct Choice {
  WaveletCompliance<3> compliance;
  double floor = 0;  // of the couplings that they keep
  std::vector<std::size_t> searched;
  FoundEncoding found;
  Measured measured;
};

// One build. The columns are transformed again with a lower floor if no encoding of the one at hand is accurate enough.
class Build {
 public:
  Build(const CompressionInput& input, const Progress& progress)
      : input_(input),
        progress_(progress),
        wavelet_(make_wavelet<3>(input.mesh, input.flags, input.area, input.wavelet, input.columns)),
        sample_(checked(input, wavelet_).mesh, wavelet_, input.area),
        contacts_(
            contact_patterns(TouchedSurface(input.mesh, input.flags, input.area, wavelet_), input.facts.max_contacts,
                             wavelet_.rows() > many_rows ? few_pattern_sites : pattern_sites),
            row_positions(input.mesh, wavelet_, wavelet_.finest())) {
    model_ = describe_mesh(input.mesh, input.flags, input.area, wavelet_, layout::Problem::elastostatic, input.facts);
    model_.provenance = input.provenance;
    add_representatives(input.mesh, input.flags, model_);
    for (const std::size_t node : wavelet_.nodes()) {
      read_.push_back((input.flags[node] & layout::node_read) != 0 ? 1 : 0);
    }
    report_.dense_bytes = 36 * wavelet_.rows() * wavelet_.rows();
  }

  [[nodiscard]] BuiltModel run() {
    const Choice choice = choose();
    encode_couplings(choice.compliance, choice.found.encoding, model_);
    report_.trials.push_back(choice.measured.trial);
    describe(choice);
    describe_levels(choice);
    store_errors(report_, model_);
    describe_frontier(choice);
    if (progress_) progress_(1.0, "done");
    return {std::move(model_), std::move(report_)};
  }

  [[nodiscard]] Choice choose() {
    for (double floor = first_floor;; floor /= 4) {
      if (auto choice = choose_with(floor)) return std::move(*choice);
      if (floor > least_floor) continue;
      if (closest_pattern_) unreachable_field(input_.accuracy, *closest_pattern_);
      unreachable_accuracy(input_.accuracy, closest_);
    }
  }

 private:
  static const CompressionInput& checked(const CompressionInput& input, const SurfaceWavelet& wavelet) {
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

  [[nodiscard]] WaveletCompliance<3> transform(double floor) {
    const ExactColumns columns = [&](std::size_t first, std::size_t count) {
      Eigen::MatrixXd block = input_.columns(first, count);
      const bool fits = block.rows() == static_cast<Eigen::Index>(3 * wavelet_.rows());
      if (floor == first_floor && fits) sample_.add(block, first);
      if (floor == first_floor && fits) contacts_.add(block, first);
      return block;
    };
    WaveletCompliance<3> compliance = transform_compliance<3>(wavelet_, columns, floor, part(0, 0.25));
    if (floor == first_floor) solve_contacts();
    return compliance;
  }

  void solve_contacts() {
    contacts_.solve();
    reserve_patterns(contacts_, model_);
    const Progress progress = part(0.25, 0.3);
    for (std::size_t first = 0; first < wavelet_.rows(); first += stream_columns) {
      const std::size_t count = std::min(stream_columns, wavelet_.rows() - first);
      contacts_.add_fields(input_.columns(first, count), first);
      progress(static_cast<double>(first + count) / static_cast<double>(wavelet_.rows()), "measure patterns");
    }
  }

  [[nodiscard]] TrialBench bench_of(const WaveletCompliance<3>& compliance) const {
    return {compliance, model_, sample_.columns(), input_.accuracy, input_.step_work};
  }

  // searches and measures until an encoding meets the accuracy on everything; none: none does with this floor
  [[nodiscard]] std::optional<Choice> choose_with(double floor) {
    WaveletCompliance<3> compliance = transform(floor);
    const TrialBench bench = bench_of(compliance);
    std::vector<std::size_t> searched = worst_patches(bench, sample_.patches(), search_patches, ranking_threshold);
    Accuracy aim = input_.accuracy;
    aim.patch_force *= safety;
    for (int round = 0; round < rounds; ++round) {
      Trial chosen =
          search_encoding(bench, sample_.patches().choose(searched), aim, floor, report_.trials, part(0.3, 0.6));
      closest_ = chosen;
      if (!chosen.meets(aim)) return {};
      auto found = meet_patterns(bench, sample_.patches().choose(searched), floor, chosen);
      if (!found) return {};
      Measured measured = measure(found->model, chosen);
      if (measured.trial.meets(input_.accuracy) && measured.least_eigenvalue > 0) {
        return Choice{std::move(compliance), floor, std::move(searched), std::move(*found), std::move(measured)};
      }
      closest_ = measured.trial;
      add_patches(measured.worst_patches, searched);
      tighten(aim, measured);
    }
    return {};
  }

  // takes a smaller threshold where the fields of what people do ask for it; none: none down to the floor will do
  [[nodiscard]] std::optional<FoundEncoding> meet_patterns(const TrialBench& bench, const ContactPatches& patches,
                                                           double floor, Trial& chosen) {
    auto found = search_threshold(bench, contacts_, chosen.encoding.threshold, floor);
    if (!found) {
      const auto errors = summarise(answer_errors(bench, contacts_, encoding_at(floor)));
      closest_pattern_ = worst_pattern(errors, input_.accuracy);
    } else if (found->encoding.threshold != chosen.encoding.threshold) {
      chosen = measure_trial(bench, patches, found->encoding, found->model, CompressedCompliance<3>(found->model.view));
    }
    return found;
  }

  [[nodiscard]] Measured measure(const ModelFile& encoded, const Trial& chosen) {
    Measured measured{.trial = chosen, .field = FieldError(read_), .worst_patches = {}};
    const CompressedCompliance<3> all(encoded.view);
    FieldError error;
    visit_exact_columns(input_, part(0.65, 0.75), [&](std::size_t row, const auto& exact, double area) {
      const auto found = all.column(all.finest(), row);
      error.add(found, exact.data(), area);
      measured.field.add(found, exact.data(), area);
    });
    measured.trial.rms = error.rms();
    measured.trial.worst_column = error.worst_column();
    const auto patches = sample_.patches().force_errors(all, wavelet_.finest());
    measured.trial.patch_force = patches.front().force;
    for (std::size_t p = 0; p < std::min(search_patches, patches.size()); ++p) {
      measured.worst_patches.push_back(patches[p].patch);
    }
    if (measured.trial.meets(input_.accuracy)) {
      measured.least_eigenvalue = estimate_least_eigenvalue(all, part(0.75, 0.85));
    }
    return measured;
  }

  // asks the next search for as much less as this one's choice fell short by; patches it has learned of itself
  void tighten(Accuracy& aim, const Measured& measured) const {
    const Trial& trial = measured.trial;
    const Accuracy& wanted = input_.accuracy;
    if (trial.meets(wanted)) {  // but it is not positive definite
      aim.patch_force *= 0.5;
      return;
    }
    aim.rms *= std::min(1.0, 0.98 * wanted.rms / trial.rms);
    aim.worst_column *= std::min(1.0, 0.98 * wanted.worst_column / trial.worst_column);
  }

  void describe(const Choice& choice) {
    report_.encoding = choice.found.encoding;
    report_.lambda_min = certificate_share * choice.measured.least_eigenvalue;
    report_.patches = sample_.patches().size();
  }

  void describe_levels(const Choice& choice) {
    const ModelFile& encoded = choice.found.model;
    const Measured& finest = choice.measured;
    const CompressedCompliance<3> complete(encoded.view);
    const AnsweredContacts answered(encoded.view, complete, contacts_);
    for (std::uint32_t level = model_.info.coarsest_constraint_level; level < wavelet_.finest(); ++level) {
      const AlignedBytes bytes(truncate_to_level({encoded.bytes.span().begin(), encoded.bytes.span().end()}, level));
      ModelView cut;
      if (!verify(bytes.span(), cut).ok()) throw std::logic_error("compression: a cut model does not verify");
      report_.levels.push_back(measure_coarse(input_, wavelet_, choice.compliance, cut, level));
      report_.levels.back().patterns = summarise(answered.all_errors(level));
    }
    report_.levels.push_back({.level = static_cast<std::uint32_t>(wavelet_.finest()),
                              .nodes = wavelet_.rows(),
                              .rms_error = finest.trial.rms,
                              .worst_column_error = finest.trial.worst_column,
                              .patch_force_error = finest.trial.patch_force,
                              .field_rms_error = finest.field.rms(),
                              .field_column_error = finest.field.worst_column(),
                              .field = field_size(encoded.view),
                              .patterns = summarise(choice.found.errors)});
    for (std::size_t details = 0; details < wavelet_.finest(); ++details) {
      const auto errors = answered.all_errors(model_.info.coarsest_constraint_level, details);
      report_.cut_errors.push_back(worst_field_error(summarise(errors)));
    }
    report_.cut_errors.push_back(worst_field_error(report_.levels.front().patterns));
    for (auto& level : report_.levels) {
      level.kept_blocks = encoded.view.level[level.level].counts->kept_blocks;
      level.dense_blocks = encoded.view.level[level.level].counts->dense_blocks;
    }
  }

  // the chosen point with the errors measured on everything
  void describe_frontier(const Choice& choice) {
    const auto samples = sample_levels(input_.mesh, wavelet_, choice.compliance, model_.info.coarsest_constraint_level);
    std::vector<Trial> trials = report_.trials;
    trials.back().levels = level_costs(choice.found.model, input_.step_work);
    for (std::size_t i = 0; i < report_.levels.size(); ++i) {
      trials.back().levels[i].rms = report_.levels[i].rms_error;
      trials.back().levels[i].worst_column = report_.levels[i].worst_column_error;
      trials.back().levels[i].patch_force = report_.levels[i].patch_force_error;
    }
    fill_gaps(report_.encoding.threshold, choice.floor, trials);
    leave_out_near(report_.encoding.threshold, trials);
    report_.frontier =
        measure_frontier(bench_of(choice.compliance), sample_.patches().choose(choice.searched), samples, trials);
  }

  const CompressionInput& input_;
  const Progress& progress_;
  SurfaceWavelet wavelet_;
  std::vector<std::uint8_t> read_;  // by rows
  ExactSample sample_;
  ExactContacts contacts_;
  ModelData model_;
  CompressionReport report_;
  Trial closest_;                                 // the last that failed
  std::optional<PatternErrors> closest_pattern_;  // if it failed by its fields
  double done_ = 0;
};

}  // namespace

BuiltModel build_model(const CompressionInput& input, const Progress& progress) { return Build(input, progress).run(); }

Trial chosen_trial(const CompressionInput& input) { return Build(input, {}).choose().measured.trial; }

}  // namespace greenloop::offline
