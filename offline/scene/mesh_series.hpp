#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/trajectory/trajectory_file.hpp"

namespace greenloop::offline {

/// The meshes of an orbit, a file each.
struct OrbitSeries {
  std::uint32_t impulse = 0;
  std::string pattern;      ///< of the files' names, seen from the working directory, with one %d or %04d
  std::int64_t first = 0;   ///< number of the first file
  std::uint64_t count = 0;  ///< of files, 2 at least
  /// An orbit before this one, and the frame of it before this one's first; none: the scene was at rest.
  std::optional<std::pair<std::uint64_t, std::uint64_t>> previous;
  bool at_rest = false;
  bool held_out = false;

  /// The file of frame k.
  [[nodiscard]] std::filesystem::path file(std::uint64_t k) const;
};

/// Somebody's animations, to become trajectories (docs/trajectories.md).
struct MeshSeries {
  double time_step = 0;  ///< s
  double unit = 0;       ///< m, of the meshes
  std::filesystem::path rest;
  std::vector<Impulse> impulses;
  std::vector<std::uint8_t> successions;  ///< as of TrajectoryScene
  std::vector<OrbitSeries> orbits;        ///< at least one
};

/// Reads and checks the description of a series. No mesh is opened. Throws SceneError.
[[nodiscard]] MeshSeries read_mesh_series(const std::filesystem::path& file);

/// The same of a text in memory; `file` is for messages and for paths relative to it.
[[nodiscard]] MeshSeries parse_mesh_series(std::string_view text, const std::filesystem::path& file);

}  // namespace greenloop::offline
