#include "offline/compress/search/encoding_search.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "offline/compress/measure/field_error.hpp"

namespace greenloop::offline {
namespace {

// rounding then weighs less than what the threshold drops
constexpr double quantum_per_threshold = 0.5;
constexpr int bisections = 9;

FieldError column_error(const TrialBench& bench, const CompressedCompliance<3>& compressed) {
  FieldError error;
  for (const auto& column : bench.columns) {
    error.add(compressed.column(compressed.finest(), column.row), column.exact.data(), column.area);
  }
  return error;
}

}  // namespace

Encoding encoding_at(double threshold) {
  return {.threshold = threshold, .quantum = quantum_per_threshold * threshold};
}

ModelData encoded_model(const TrialBench& bench, const Encoding& encoding) {
  ModelData model = bench.tables;
  encode_couplings(bench.compliance, encoding, model);
  return model;
}

Trial measure_trial(const TrialBench& bench, const ContactPatches& patches, const Encoding& encoding,
                    const ModelFile& model, const CompressedCompliance<3>& compressed) {
  Trial trial{.encoding = encoding, .bytes = model.bytes.size()};
  trial.blocks = model.view.level[model.view.levels - 1].counts->kept_blocks;
  trial.patch_force = patches.worst_force_error(compressed, compressed.finest());
  const FieldError error = column_error(bench, compressed);
  trial.rms = error.rms();
  trial.worst_column = error.worst_column();
  if (bench.step_work) trial.step_work = bench.step_work(model.bytes.span()).back();
  return trial;
}

Trial try_encoding(const TrialBench& bench, const ContactPatches& patches, const Encoding& encoding) {
  const ModelFile model = encoded_file(encoded_model(bench, encoding));
  return measure_trial(bench, patches, encoding, model, CompressedCompliance<3>(model.view));
}

std::vector<std::size_t> worst_patches(const TrialBench& bench, const ContactPatches& patches, std::size_t count,
                                       double threshold) {
  const ModelFile model = encoded_file(encoded_model(bench, encoding_at(threshold)));
  const CompressedCompliance<3> compressed(model.view);
  std::vector<std::size_t> worst;
  for (const auto& error : patches.force_errors(compressed, compressed.finest())) {
    if (worst.size() < count) worst.push_back(error.patch);
  }
  return worst;
}

Trial search_encoding(const TrialBench& bench, const ContactPatches& patches, const Accuracy& accuracy, double floor,
                      std::vector<Trial>& trials, const Progress& progress) {
  Trial best, closest;
  double fails = 0.5, meets = floor;
  for (int step = 0; step <= bisections; ++step) {
    // the floor itself first: if that fails nothing helps
    const double threshold = step == 0 ? floor : std::sqrt(fails * meets);
    const Trial trial = try_encoding(bench, patches, encoding_at(threshold));
    trials.push_back(trial);
    if (progress) progress(static_cast<double>(step + 1) / (bisections + 1), "search threshold");
    if (closest.bytes == 0 || trial.patch_force < closest.patch_force) closest = trial;
    if (trial.meets(accuracy)) {
      meets = threshold;
      if (best.bytes == 0 || trial.bytes < best.bytes) best = trial;
    } else {
      fails = threshold;
      if (step == 0) break;
    }
  }
  return best.bytes > 0 ? best : closest;
}

}  // namespace greenloop::offline
