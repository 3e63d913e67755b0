#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "offline/scene/sheet.hpp"

namespace greenloop::offline {

/// What scene.toml asks for where it names trajectories: an impulse response model of them (docs/trajectories.md).
struct MotionScene {
  std::filesystem::path trajectories;  ///< HDF5, seen from the working directory
  std::string name;                    ///< as the scene says
  double truncation = 0.01;            ///< modes below this part of the largest singular value are left out, 0..1
  double quantisation = 0.01;          ///< root mean square error of quantised displacements, relative, 0..1
  double dead_end = 0.5;               ///< how far an orbit may end from where it goes on, of the largest state, 0..10
  std::optional<double> blend_rate;    ///< 1/s; none: chosen by the lengths of orbits
  std::size_t memory = 512U << 20;     ///< bytes that reduction may take, 64 MB at least
  std::optional<double> rate;          ///< Hz, of the loop; none: a step for each frame
  std::optional<Sheet> sheet;          ///< if what was simulated is one
};

/// Reads and checks such a scene; none if it is a scene of another kind, without [trajectories]. No file that it names
/// is opened. Throws SceneError.
[[nodiscard]] std::optional<MotionScene> read_motion_scene(const std::filesystem::path& file);

/// The same for a scene in memory; `file` is for messages and for paths relative to it.
[[nodiscard]] std::optional<MotionScene> parse_motion_scene(std::string_view text, const std::filesystem::path& file);

/// The scene as TOML, every key of the model, always in the same order; parsing it gives the same model.
[[nodiscard]] std::string canonical_text(const MotionScene& scene);

}  // namespace greenloop::offline
