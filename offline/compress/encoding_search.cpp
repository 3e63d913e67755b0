#include "offline/compress/encoding_search.hpp"

#include <cmath>
#include <stdexcept>

#include "formats/aligned_bytes.hpp"
#include "formats/verify.hpp"
#include "offline/compress/field_error.hpp"

namespace greenloop::offline {
namespace {

// a weak block's rounding then weighs about as much as what the threshold drops
constexpr double quantum_per_threshold = 1.5;
constexpr int bisections = 6;

Encoding encoding_at(double threshold, std::uint32_t strong_bits) {
  return {.threshold = threshold, .weak_quantum = quantum_per_threshold * threshold, .strong_bits = strong_bits};
}

}  // namespace

Trial try_encoding(const TrialBench& bench, const ContactPatches& patches, const Encoding& encoding) {
  ModelData model = bench.tables;
  encode_couplings(bench.pyramid, encoding, model);
  const AlignedBytes bytes(encode(model));
  ModelView view;
  if (const auto result = verify(bytes.span(), view); !result.ok()) {
    throw std::logic_error(std::string("compression: an encoded model does not verify: ") + result.field);
  }
  const CompressedCompliance compressed(view, 2);
  Trial trial{.encoding = encoding, .bytes = bytes.size()};
  trial.blocks = view.level[view.levels - 1].counts->kept_blocks;
  trial.patch_force = patches.worst_force_error(compressed, compressed.finest());
  FieldError error;
  for (const auto& column : bench.columns) {
    error.add(compressed, compressed.finest(), column.row, column.exact.data(), column.area);
  }
  trial.rms = error.rms();
  trial.worst_column = error.worst_column();
  if (bench.step_work) trial.step_work = bench.step_work(bytes.span());
  return trial;
}

Trial search_encoding(const TrialBench& bench, const ContactPatches& patches, const Accuracy& accuracy, double floor,
                      std::vector<Trial>& trials, const Progress& progress) {
  Trial best;
  Trial closest;
  int done = 0;
  for (const std::uint32_t bits : {8U, 16U}) {
    double fails = 0.5, meets = floor;
    for (int step = 0; step <= bisections; ++step) {
      // the floor itself first: if that fails nothing helps
      const double threshold = step == 0 ? floor : std::sqrt(fails * meets);
      trials.push_back(try_encoding(bench, patches, encoding_at(threshold, bits)));
      const Trial& trial = trials.back();
      progress(static_cast<double>(++done) / (2 * bisections + 2), "search threshold and bits");
      if (closest.bytes == 0 || trial.patch_force < closest.patch_force) closest = trial;
      if (!trial.meets(accuracy)) {
        fails = threshold;
        if (step == 0) break;
        continue;
      }
      meets = threshold;
      if (best.bytes == 0 || trial.bytes < best.bytes) best = trial;
    }
  }
  return best.bytes > 0 ? best : closest;
}

}  // namespace greenloop::offline
