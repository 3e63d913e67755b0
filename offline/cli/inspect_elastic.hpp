#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "formats/write/model_file.hpp"

namespace greenloop::offline {

/// What a multigrid model holds, for `inspect --json`: its kind, grids (levels, finest first), tetrahedra, materials,
/// time step, the work of a step and the cycles of a first one under the body's weight. Work: linear in the model.
[[nodiscard]] nlohmann::ordered_json elastic_inspection(const ModelFile& model,
                                                        const nlohmann::ordered_json& provenance);

/// The same for people.
void print_elastic_table(const std::filesystem::path& file, const nlohmann::ordered_json& found, std::ostream& out);

}  // namespace greenloop::offline
