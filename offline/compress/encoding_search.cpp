#include "offline/compress/encoding_search.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/verify.hpp"
#include "offline/compress/field_error.hpp"

namespace greenloop::offline {
namespace {

// rounding then weighs less than what the threshold drops
constexpr double quantum_per_threshold = 0.5;
constexpr int bisections = 9;
constexpr double least_gain = 1.25, most_gain = 2;  // of a coefficient's weight at a time

Encoding encoding_at(double threshold) {
  return {.threshold = threshold, .quantum = quantum_per_threshold * threshold};
}

ModelData encoded(const TrialBench& bench, const Encoding& encoding) {
  ModelData model = bench.tables;
  encode_couplings(bench.compliance, encoding, model);
  return model;
}

FieldError field_error(const TrialBench& bench, const CompressedCompliance& compressed) {
  FieldError error;
  for (const auto& column : bench.columns) {
    error.add(compressed, compressed.finest(), column.row, column.exact.data(), column.area);
  }
  return error;
}

}  // namespace

EncodedModel::EncodedModel(const ModelData& model) : bytes(encode(model)) {
  if (const auto result = verify(bytes.span(), view); !result.ok()) {
    throw std::logic_error(std::string("compression: an encoded model does not verify: ") + result.field);
  }
}

Trial try_encoding(const TrialBench& bench, const ContactPatches& patches, const Encoding& encoding) {
  const EncodedModel model(encoded(bench, encoding));
  const CompressedCompliance compressed(model.view, layout::layers);
  Trial trial{.encoding = encoding, .bytes = model.bytes.size()};
  trial.blocks = model.view.level[model.view.levels - 1].counts->kept_blocks;
  trial.patch_force = patches.worst_force_error(compressed, compressed.finest());
  const FieldError error = field_error(bench, compressed);
  trial.rms = error.rms();
  trial.worst_column = error.worst_column();
  if (bench.step_work) trial.step_work = bench.step_work(model.bytes.span());
  return trial;
}

std::vector<std::size_t> worst_patches(const TrialBench& bench, const ContactPatches& patches, std::size_t count,
                                       double threshold) {
  const EncodedModel model(encoded(bench, encoding_at(threshold)));
  const CompressedCompliance compressed(model.view, layout::layers);
  std::vector<std::size_t> worst;
  for (const auto& error : patches.force_errors(compressed, compressed.finest())) {
    if (worst.size() < count) worst.push_back(error.patch);
  }
  return worst;
}

Encoding search_field_threshold(const TrialBench& bench, double rms, Encoding encoding, const Progress& progress) {
  double fails = 2, meets = 0.001;  // couplings are at most about as large as their coefficients' diagonal blocks
  bool found = false;
  for (int step = 0; step <= bisections; ++step) {
    Encoding trial = encoding;
    trial.field_threshold = step == 0 ? meets : std::sqrt(fails * meets);
    const EncodedModel model(encoded(bench, trial));
    const FieldError error = field_error(bench, CompressedCompliance(model.view, layout::field_layers));
    if (progress) progress(static_cast<double>(step + 1) / (bisections + 1), "search field threshold");
    if (error.rms() <= rms) {
      found = true;
      meets = trial.field_threshold;
    } else if (step == 0) {
      break;
    } else {
      fails = trial.field_threshold;
    }
  }
  encoding.field_threshold = found ? meets : 0;
  return encoding;
}

void weigh_columns(const LinearWavelet& wavelet, const WaveletCompliance& compliance,
                   const std::vector<PoorColumn>& columns, Encoding& encoding) {
  std::vector<double> factor(wavelet.rows(), 1.0), force(wavelet.rows());
  for (const PoorColumn& column : columns) {
    std::fill(force.begin(), force.end(), 0.0);
    force[column.row] = 1;
    for (std::size_t level = wavelet.finest(); level > 0; --level) wavelet.split_forces(level, 1, force.data());
    double most = 0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      if (force[i] == 0) continue;
      const CoefficientScale& scale = compliance.scales[i];
      force[i] = std::abs(force[i]) * (scale.root() * scale.diagonal() * scale.root()).norm();
      most = std::max(most, force[i]);
    }
    const double gain = std::clamp(column.excess, least_gain, most_gain) - 1;
    for (std::size_t i = 0; i < force.size(); ++i) factor[i] = std::max(factor[i], 1 + gain * force[i] / most);
  }
  encoding.field_weight.resize(wavelet.rows(), 1.0);
  for (std::size_t i = 0; i < factor.size(); ++i) encoding.field_weight[i] *= factor[i];
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
