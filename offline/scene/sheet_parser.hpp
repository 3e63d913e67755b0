#pragma once

#include <optional>

#include "offline/scene/sheet.hpp"
#include "offline/scene/toml_table.hpp"

namespace greenloop::offline {

/// [sheet] and [[rigid]] of a scene.
[[nodiscard]] std::optional<Sheet> read_sheet(const Table& scene);

}  // namespace greenloop::offline
