#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>

#include "formats/view.hpp"

namespace greenloop::offline {

/// What a step of a model costs, as far as it is known.
struct StepCost {
  std::optional<std::uint64_t> arena_bytes;  ///< RAM of a body
  std::optional<double> us;                  ///< of the budget's work
  std::optional<double> asked_us;            ///< what a step may take
  std::string speed;                         ///< what `us` is by, in words
};

/// What the scene in a model's provenance asked for beside what the model reaches at its finest level:
/// {verdict, sentence, warning, compression_error: {rms, worst_column, patch_force, field, field_peak, field_rough},
/// mesh_error, step_us, arena_bytes}, an error as {asked, reached, held}, what is not known or not asked null. Judged
/// are the errors of which something is asked: "HELD", "VIOLATED", or "NOT JUDGED" where the scene is not known. A mesh
/// error that is not judged and above what is asked of patch_force is a warning, which ends the sentence.
[[nodiscard]] nlohmann::ordered_json quality_of(const ModelView& view, const StepCost& cost);

/// The sentence and a table.
void print_quality(const nlohmann::ordered_json& quality, std::ostream& out);

}  // namespace greenloop::offline
