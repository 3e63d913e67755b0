#include "offline/figures/two_sided_form.hpp"

#include <algorithm>
#include <numeric>

#include "offline/compress/encode/model_tables.hpp"

namespace greenloop::offline {
namespace {

ModelData tables_of(const ExactBody& body, const SurfaceWavelet& wavelet) {
  layout::Info facts{};
  facts.young = 1;
  facts.rate = 1000;
  facts.max_contacts = 16;
  facts.step_work = 1;
  ModelData tables = describe_mesh(body.mesh, body.flags, body.area, wavelet, layout::Problem::elastostatic, facts);
  tables.provenance = "{}";
  add_representatives(body.mesh, body.flags, tables);
  return tables;
}

WaveletCompliance<3> transformed(const ExactBody& body, const SurfaceWavelet& wavelet, double floor,
                                 ExactSample& sample, const Progress& progress) {
  const ExactColumns columns = [&](std::size_t first, std::size_t count) {
    Eigen::MatrixXd block = body.columns(first, count);
    sample.add(block, first);
    return block;
  };
  return transform_compliance<3>(wavelet, columns, floor, progress);
}

ContactPatches first_patches(const ContactPatches& patches) {
  std::vector<std::size_t> numbers(std::min(figure_patches, patches.size()));
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return patches.choose(numbers);
}

RatePoint point_of(const LevelTrial& trial, double threshold, std::size_t rows) {
  return {.threshold = threshold,
          .ratio = static_cast<double>(rows) * static_cast<double>(rows) / static_cast<double>(trial.blocks),
          .bytes = static_cast<double>(trial.bytes),
          .rms = trial.rms,
          .worst_column = trial.worst_column,
          .patch_force = trial.patch_force};
}

}  // namespace

TwoSidedForm::TwoSidedForm(const ExactBody& body, const WaveletKind& kind, double floor, const Progress& progress)
    : wavelet_(body.mesh, body.flags, body.area, kind.wavelet),
      sample_(body.mesh, wavelet_, body.area),
      compliance_(transformed(body, wavelet_, floor, sample_, progress)),
      tables_(tables_of(body, wavelet_)),
      patches_(first_patches(sample_.patches())),
      coarse_(sample_levels(body.mesh, wavelet_, compliance_, tables_.info.coarsest_constraint_level)) {}

std::vector<LevelRates> TwoSidedForm::rates(const std::vector<double>& thresholds, double quantum) const {
  std::vector<Trial> trials;
  for (const double threshold : thresholds) {
    trials.push_back({.encoding = {.threshold = threshold, .quantum = quantum * threshold}});
  }
  auto points = measure_frontier(bench(), patches_, coarse_, trials);
  std::reverse(points.begin(), points.end());
  std::vector<LevelRates> levels;
  for (const LevelTrial& first : points.front().levels) {
    const std::size_t level = first.level, count = wavelet_.row_end(level), index = levels.size();
    levels.push_back({.level = level, .columns = count, .points = {}});
    for (const Trial& point : points) {
      levels.back().points.push_back(point_of(point.levels[index], point.encoding.threshold, count));
    }
  }
  return levels;
}

ModelData TwoSidedForm::model(double threshold) const { return encoded_model(bench(), encoding_at(threshold)); }

}  // namespace greenloop::offline
