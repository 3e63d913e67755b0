#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "formats/write/model_file.hpp"

namespace greenloop::offline {

/// The loop that a model is meant for, and what it costs: {work, rate, share, share_us, contacts} of the file;
/// {least_work, worst_work, arena_bytes} that are declared for its limits; and of the machine that asks, by the
/// processor time of steps that are run for a moment, {us, us_p95, least_us, worst_us, units_per_us, steps, create_ms}.
/// What is not known is null: of a scalar model, and where a body takes more than a gibibyte.
[[nodiscard]] nlohmann::ordered_json budget_of(const ModelFile& model);

/// The same for people: names and values of a table's rows.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> budget_rows(const nlohmann::ordered_json& budget);

}  // namespace greenloop::offline
