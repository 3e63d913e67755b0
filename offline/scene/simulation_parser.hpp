#pragma once

#include <filesystem>

#include "offline/scene/scene.hpp"
#include "offline/scene/toml_table.hpp"

namespace greenloop::offline {

/// [simulate], [[impulses]] and [trajectories] of a scene, whose mesh and material were read before.
void read_simulation(const Table& table, const std::filesystem::path& file, Scene& scene);

}  // namespace greenloop::offline
