#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "formats/view.hpp"
#include "formats/write/model_file.hpp"
#include "offline/compress/encode/coupling_coder.hpp"
#include "offline/compress/measure/contact_patches.hpp"
#include "offline/compress/measure/exact_sample.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// The errors a model may have against the exact compliance, all relative.
struct Accuracy {
  double rms = 0;                                                ///< of the field: FieldError::rms
  double worst_column = 0;                                       ///< FieldError::worst_column
  double patch_force = 0;                                        ///< ContactPatches::worst_force_error
  double field = std::numeric_limits<double>::infinity();        ///< of the worst pattern: AnswerError::field
  double field_peak = std::numeric_limits<double>::infinity();   ///< AnswerError::peak
  double field_rough = std::numeric_limits<double>::infinity();  ///< AnswerError::field of patterns that are is_rough
};

/// What an encoding comes to on one constraint level.
struct LevelTrial {
  std::uint32_t level = 0;
  std::size_t bytes = 0, blocks = 0;  ///< of the model cut off after the level
  double rms = 0, worst_column = 0, patch_force = 0;
  std::uint64_t step_work = 0;  ///< units, of a step resolved at the level
};

/// One way to encode a model, and what came of it on a sample of patches and columns.
struct Trial {
  Encoding encoding;
  std::size_t bytes = 0, blocks = 0;
  double rms = 0, worst_column = 0, patch_force = 0;
  std::uint64_t step_work = 0;       ///< units
  std::vector<LevelTrial> levels{};  ///< coarse to fine; empty until measure_frontier

  [[nodiscard]] bool meets(const Accuracy& accuracy) const {
    return rms <= accuracy.rms && worst_column <= accuracy.worst_column && patch_force <= accuracy.patch_force;
  }
};

/// Work [units] of a step that is resolved at each level of an encoded model.
using LevelWork = std::function<std::vector<std::uint64_t>(std::span<const std::byte>)>;

/// What trials are made and measured with. The referenced objects must outlive the search.
struct TrialBench {
  const WaveletCompliance<3>& compliance;
  const ModelData& tables;  ///< the model without scales and couplings
  const std::vector<SampleColumn>& columns;
  Accuracy accuracy;    ///< asked for
  LevelWork step_work;  ///< may be empty
};

/// The encoding that is tried with a threshold: its quantum is half of that.
[[nodiscard]] Encoding encoding_at(double threshold);

/// The bench's model with its couplings.
[[nodiscard]] ModelData encoded_model(const TrialBench& bench, const Encoding& encoding);

/// What an encoding comes to, by the model that it makes. Work: 64 columns a patch and the sample's columns.
[[nodiscard]] Trial measure_trial(const TrialBench& bench, const ContactPatches& patches, const Encoding& encoding,
                                  const ModelFile& model, const CompressedCompliance<3>& compressed);

/// Encodes and measures one trial.
[[nodiscard]] Trial try_encoding(const TrialBench& bench, const ContactPatches& patches, const Encoding& encoding);

/// The `count` patches, by number, whose forces suffer most from an encoding of this threshold. Work: 64 columns per
/// patch.
[[nodiscard]] std::vector<std::size_t> worst_patches(const TrialBench& bench, const ContactPatches& patches,
                                                     std::size_t count, double threshold);

/// The trial of fewest bytes that meets `accuracy`: the largest threshold by bisection between `floor` and 1/2. If none
/// does, the most accurate one. Adds every trial to `trials`.
[[nodiscard]] Trial search_encoding(const TrialBench& bench, const ContactPatches& patches, const Accuracy& accuracy,
                                    double floor, std::vector<Trial>& trials, const Progress& progress);

}  // namespace greenloop::offline
