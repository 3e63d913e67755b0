#include "offline/compress/encoding_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/verify.hpp"
#include "offline/compress/field_error.hpp"

namespace greenloop::offline {
namespace {

// rounding then weighs less than what the threshold drops
constexpr double quantum_per_threshold = 0.5;
constexpr int bisections = 7;

constexpr double coarse_threshold = 0.005;  // that ranks the patches first

Encoding encoding_at(double threshold) {
  return {.threshold = threshold, .quantum = quantum_per_threshold * threshold};
}

ModelData encoded(const TrialBench& bench, const Encoding& encoding) {
  ModelData model = bench.tables;
  encode_couplings(bench.pyramid, encoding, model);
  return model;
}

// [patch] minus its error, so that the worst sort first
std::vector<std::pair<double, std::size_t>> ranked(const TrialBench& bench, const ContactPatches& patches,
                                                   const std::vector<std::size_t>& which, double threshold) {
  const EncodedModel model(encoded(bench, encoding_at(threshold)));
  const CompressedCompliance compressed(model.view, all_layers);
  std::vector<std::pair<double, std::size_t>> errors;
  errors.reserve(which.size());
  for (const std::size_t p : which) errors.emplace_back(-patches.force_error(compressed, compressed.finest(), p), p);
  std::sort(errors.begin(), errors.end());
  return errors;
}

FieldError field_error(const TrialBench& bench, const CompressedCompliance& compressed) {
  FieldError error;
  for (const auto& column : bench.columns) {
    error.add(compressed, compressed.finest(), column.row, column.exact.data(), column.area);
  }
  return error;
}

// made once
Trial trial_at(const TrialBench& bench, const ContactPatches& patches, double threshold, std::vector<Trial>& trials) {
  const auto made = std::find_if(trials.begin(), trials.end(),
                                 [&](const Trial& trial) { return trial.encoding.threshold == threshold; });
  if (made != trials.end()) return *made;
  trials.push_back(try_encoding(bench, patches, encoding_at(threshold)));
  return trials.back();
}

}  // namespace

EncodedModel::EncodedModel(const ModelData& model) : bytes(encode(model)) {
  if (const auto result = verify(bytes.span(), view); !result.ok()) {
    throw std::logic_error(std::string("compression: an encoded model does not verify: ") + result.field);
  }
}

Trial try_encoding(const TrialBench& bench, const ContactPatches& patches, const Encoding& encoding) {
  const EncodedModel model(encoded(bench, encoding));
  const CompressedCompliance compressed(model.view, all_layers);
  Trial trial{.encoding = encoding, .bytes = model.bytes.size()};
  trial.blocks = model.view.level[model.view.levels - 1].counts->kept_blocks;
  trial.patch_force = patches.worst_force_error(compressed, compressed.finest());
  const FieldError error = field_error(bench, compressed);
  trial.rms = error.rms();
  trial.worst_column = error.worst_column();
  if (bench.step_work) trial.step_work = bench.step_work(model.bytes.span());
  return trial;
}

ContactPatches worst_patches(const TrialBench& bench, const ContactPatches& patches, std::size_t count, double floor) {
  std::vector<std::size_t> worst(patches.size());
  std::iota(worst.begin(), worst.end(), std::size_t{0});
  double threshold = std::max(coarse_threshold, floor);
  while (worst.size() > count) {
    const auto errors = ranked(bench, patches, worst, threshold);
    const auto indefinite = static_cast<std::size_t>(
        std::count_if(errors.begin(), errors.end(), [](const auto& error) { return std::isinf(error.first); }));
    const bool decided = indefinite <= count || threshold <= floor;
    worst.clear();
    for (std::size_t i = 0; i < (decided ? count : indefinite); ++i) worst.push_back(errors[i].second);
    threshold = std::max(threshold / 4, floor);
  }
  return patches.choose(worst);
}

Encoding search_field_threshold(const TrialBench& bench, const Accuracy& accuracy, Encoding encoding,
                                const Progress& progress) {
  double fails = 2, meets = 0.01;  // couplings are at most about as large as their coefficients' diagonal blocks
  bool found = false;
  for (int step = 0; step <= bisections; ++step) {
    Encoding trial = encoding;
    trial.field_threshold = step == 0 ? meets : std::sqrt(fails * meets);
    const EncodedModel model(encoded(bench, trial));
    const FieldError error = field_error(bench, CompressedCompliance(model.view, 1));
    progress(static_cast<double>(step + 1) / (bisections + 1), "search field threshold");
    if (error.rms() <= accuracy.rms && error.worst_column() <= accuracy.worst_column) {
      found = true;
      meets = trial.field_threshold;
    } else if (step == 0) {
      break;
    } else {
      fails = trial.field_threshold;
    }
  }
  if (found) encoding.field_threshold = meets;
  return encoding;
}

Trial search_encoding(const TrialBench& bench, const ContactPatches& patches, const Accuracy& accuracy, double floor,
                      std::vector<Trial>& trials, const Progress& progress) {
  Trial best, closest;
  double fails = 0.5, meets = floor;
  for (int step = 0; step <= bisections; ++step) {
    // the floor itself first: if that fails nothing helps
    const double threshold = step == 0 ? floor : std::sqrt(fails * meets);
    const Trial trial = trial_at(bench, patches, threshold, trials);
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
