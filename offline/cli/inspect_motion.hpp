#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "formats/write/model_file.hpp"

namespace greenloop::offline {

/// What an impulse response model holds, for `inspect --json`: its kind, modes (rank), states, orbits, impulses, errors
/// and, from the provenance, the error of its replay. Work: linear in the orbits and states.
[[nodiscard]] nlohmann::ordered_json motion_inspection(const ModelFile& model,
                                                       const nlohmann::ordered_json& provenance);

/// The same for people.
void print_motion_table(const std::filesystem::path& file, const nlohmann::ordered_json& found, std::ostream& out);

}  // namespace greenloop::offline
