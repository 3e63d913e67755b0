#include "offline/compress/search/frontier.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <utility>

#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/measure/field_error.hpp"

namespace greenloop::offline {
namespace {

LevelSample sample_level(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet, const WaveletCompliance<3>& exact,
                         std::size_t level) {
  LevelSample sample{.level = level,
                     .patches = ContactPatches(row_positions(mesh, wavelet, level), LevelSample::most_patches),
                     .columns = {}};
  const std::size_t rows = wavelet.row_end(level);
  for (const std::size_t j : sample.patches.rows()) {
    const auto column = exact_column(wavelet, exact, level, j);
    Eigen::MatrixXd block(3 * rows, 3);
    for (std::size_t i = 0; i < rows; ++i) {
      block.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = Eigen::Map<const Eigen::Matrix3d>(column.data() + 9 * i);
    }
    sample.patches.add(block, j);
  }
  const std::size_t count = std::min(LevelSample::most_columns, rows);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = i * rows / count;
    sample.columns.push_back(
        {.row = j, .area = wavelet.integrals(level)[j], .exact = exact_column(wavelet, exact, level, j)});
  }
  return sample;
}

void measure_level(const LevelSample& sample, const CompressedCompliance<3>& compressed, LevelTrial& trial) {
  FieldError error;
  for (const auto& column : sample.columns) {
    error.add(compressed.column(sample.level, column.row), column.exact.data(), column.area);
  }
  trial.rms = error.rms();
  trial.worst_column = error.worst_column();
  trial.patch_force = sample.patches.worst_force_error(compressed, sample.level);
}

void measure_levels(const TrialBench& bench, const ContactPatches& patches, const std::vector<LevelSample>& samples,
                    Trial& trial) {
  const ModelFile model = encoded_file(encoded_model(bench, trial.encoding));
  const CompressedCompliance<3> compressed(model.view);
  if (trial.bytes == 0) trial = measure_trial(bench, patches, trial.encoding, model, compressed);
  trial.levels = level_costs(model, bench.step_work);
  for (std::size_t i = 0; i < samples.size(); ++i) measure_level(samples[i], compressed, trial.levels[i]);
  LevelTrial& finest = trial.levels.back();
  finest.rms = trial.rms;
  finest.worst_column = trial.worst_column;
  finest.patch_force = trial.patch_force;
}

// of truncate_to_level's result: where the next level's sections begin
std::size_t bytes_up_to(const ModelFile& model, std::uint32_t level) {
  const auto bytes = model.bytes.span();
  for (std::uint32_t i = 0; i < model.view.header->section_count; ++i) {
    layout::SectionEntry entry;
    std::memcpy(&entry, bytes.data() + sizeof(layout::Header) + i * sizeof(entry), sizeof(entry));
    const bool level_begins = entry.kind == static_cast<std::uint32_t>(layout::SectionKind::level);
    if (level_begins && entry.a == level + 1) return static_cast<std::size_t>(entry.offset);
  }
  return bytes.size();
}

}  // namespace

std::vector<LevelSample> sample_levels(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet,
                                       const WaveletCompliance<3>& exact, std::size_t coarsest) {
  std::vector<LevelSample> samples;
  for (std::size_t level = coarsest; level < wavelet.finest(); ++level) {
    samples.push_back(sample_level(mesh, wavelet, exact, level));
  }
  return samples;
}

std::vector<LevelTrial> level_costs(const ModelFile& model, const LevelWork& work) {
  const auto units = work ? work(model.bytes.span()) : std::vector<std::uint64_t>(model.view.levels, 0);
  std::vector<LevelTrial> levels;
  for (std::uint32_t level = model.view.info->coarsest_constraint_level; level < model.view.levels; ++level) {
    levels.push_back({.level = level,
                      .bytes = bytes_up_to(model, level),
                      .blocks = model.view.level[level].counts->kept_blocks,
                      .step_work = units[level]});
  }
  return levels;
}

void fill_gaps(double chosen, double floor, std::vector<Trial>& trials) {
  constexpr double near = 1.4;
  for (double threshold = 16 * chosen; threshold > 0.4 * chosen; threshold /= 2) {
    const bool tried = std::any_of(trials.begin(), trials.end(), [&](const Trial& trial) {
      return trial.encoding.threshold < near * threshold && threshold < near * trial.encoding.threshold;
    });
    if (!tried && threshold >= floor) trials.push_back({.encoding = encoding_at(threshold)});
  }
}

void leave_out_near(double chosen, std::vector<Trial>& trials) {
  constexpr double near = 1.1;
  std::vector<double> kept = {chosen};
  const auto known = [&](double threshold) {
    return std::any_of(kept.begin(), kept.end(),
                       [&](double other) { return other < near * threshold && threshold < near * other; });
  };
  std::vector<Trial> apart;
  for (Trial& trial : trials) {
    const double threshold = trial.encoding.threshold;
    if (threshold != chosen && known(threshold)) continue;
    kept.push_back(threshold);
    apart.push_back(std::move(trial));
  }
  trials = std::move(apart);
}

std::vector<Trial> measure_frontier(const TrialBench& bench, const ContactPatches& patches,
                                    const std::vector<LevelSample>& samples, const std::vector<Trial>& trials) {
  std::map<double, Trial, std::greater<>> latest;
  for (const auto& trial : trials) latest[trial.encoding.threshold] = trial;
  std::vector<Trial> points;
  for (auto& [threshold, trial] : latest) {
    if (trial.levels.empty()) measure_levels(bench, patches, samples, trial);
    points.push_back(std::move(trial));
  }
  return points;
}

}  // namespace greenloop::offline
