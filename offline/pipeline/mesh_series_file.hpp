#pragma once

#include <filesystem>

#include "formats/mesh/mesh_text.hpp"
#include "offline/scene/mesh_series.hpp"

namespace greenloop::offline {

/// Reads the meshes of a series one after the other and writes their vertices as trajectories, in metres. Everything
/// but the vertices' places must be the same in all of them. Throws MeshFileError or std::runtime_error naming the
/// file.
void write_mesh_series(const MeshSeries& series, const std::filesystem::path& output, MeshNotes& notes);

}  // namespace greenloop::offline
