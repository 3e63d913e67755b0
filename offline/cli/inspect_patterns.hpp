#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

#include "formats/view.hpp"

namespace greenloop::offline {

/// What the file says of contact patterns, coarse to fine: {kind, contacts, level, samples, field_error: {median, p95,
/// worst}, field_peak: {...}, force_error: {...}, total_force_error: {...} or null}. Empty if none were measured.
[[nodiscard]] nlohmann::ordered_json patterns_of(const ModelView& view);

/// The worst errors of each kind at the finest level of `patterns`, as a table; nothing if there are none.
void print_patterns(const nlohmann::ordered_json& patterns, std::ostream& out);

}  // namespace greenloop::offline
