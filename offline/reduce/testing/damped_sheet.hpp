#pragma once

#include <cstdint>
#include <filesystem>

#include "formats/trajectory/trajectory_file.hpp"

namespace greenloop::offline {

/// Trajectories of a sheet that swings in nine damped modes, each exactly solved; where it bends, it is drawn inwards,
/// which is not linear. Three impulses push it up, down and askew; any may follow any.
struct DampedSheet {
  int side = 14;              ///< vertices
  int orbits = 24;            ///< to build from
  int held_out = 0;           ///< more of them, the first ones: the same however many follow
  bool comes_to_rest = true;  ///< every third orbit
  std::uint64_t seed = 1;
};

/// What the file of such a sheet says but for orbits.
[[nodiscard]] TrajectoryScene sheet_scene(const DampedSheet& sheet);

/// Writes the file. Frames are 1/60 s apart.
void write_sheet(const std::filesystem::path& path, const DampedSheet& sheet);

}  // namespace greenloop::offline
