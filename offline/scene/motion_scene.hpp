#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "offline/scene/region.hpp"
#include "offline/scene/sheet.hpp"

namespace greenloop::offline {

/// Part of a surface with a reflectance of its own.
struct PaintedPart {
  BoxRegion box;  ///< of the scene's mean shape
  Eigen::Vector3d reflectance;
};

/// How a scene looks in light from far around.
struct AppearanceScene {
  Eigen::Vector3d reflectance = Eigen::Vector3d::Constant(0.7);  ///< red, green, blue, 0..1
  std::vector<PaintedPart> parts;                                ///< later ones over earlier ones
  double error = 0.1;           ///< of states that light is not computed for, relative to the variation, 0..1
  std::uint32_t rank = 12;      ///< modes at most
  std::uint32_t states = 64;    ///< that light is computed for, at most
  std::uint32_t rays = 256;     ///< from each vertex
  std::uint32_t bounces = 256;  ///< of light, at most
};

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
  std::optional<AppearanceScene> appearance;
  std::optional<Sheet> sheet;  ///< if what was simulated is one
};

/// Reads and checks such a scene; none if it is a scene of another kind, without [trajectories]. No file that it names
/// is opened. Throws SceneError.
[[nodiscard]] std::optional<MotionScene> read_motion_scene(const std::filesystem::path& file);

/// The same for a scene in memory; `file` is for messages and for paths relative to it.
[[nodiscard]] std::optional<MotionScene> parse_motion_scene(std::string_view text, const std::filesystem::path& file);

/// The scene as TOML, every key of the model, always in the same order; parsing it gives the same model.
[[nodiscard]] std::string canonical_text(const MotionScene& scene);

}  // namespace greenloop::offline
