#pragma once

#include <cstdint>

#include "formats/store/hdf5_file.hpp"
#include "formats/trajectory/trajectory_file.hpp"

namespace greenloop {

inline constexpr int kTrajectoryVersion = 1;
inline constexpr const char* kTrajectoryDocument = "docs/trajectories.md";
inline constexpr const char* kFrames = "/frames";

/// Throws std::invalid_argument naming the field that is wrong of a scene whose file has so many frames.
void require_valid(const TrajectoryScene& scene, std::uint64_t frames);

/// Everything but orbits and frames.
void write_scene(Hdf5File& file, const TrajectoryScene& scene);
/// With orbits, those that are done; checked. Throws std::runtime_error.
[[nodiscard]] TrajectoryScene read_scene(const Hdf5File& file);

/// Room for so many orbits, none of them done.
void reserve_orbits(Hdf5File& file, std::uint64_t orbits);
/// How many there is room for.
[[nodiscard]] std::uint64_t orbit_room(const Hdf5File& file);
/// Puts it in place `index`; it counts after mark_done.
void write_orbit(Hdf5File& file, std::uint64_t index, const TrajectoryOrbit& orbit);
void mark_done(Hdf5File& file, std::uint64_t index);

/// Frames for which the file has room. Throws unless /frames has the shape of the scene.
[[nodiscard]] std::uint64_t frame_room(const Hdf5File& file, const TrajectoryScene& scene);
/// Throws unless all of the values are finite; `first` names the frame.
void read_finite_frames(const Hdf5File& file, const TrajectoryScene& scene, std::uint64_t end, std::uint64_t first,
                        std::uint64_t count, std::span<float> positions);

/// The file of either door, all datasets apart from one another.
[[nodiscard]] Hdf5File open_trajectories(const std::filesystem::path& path, bool writable);

}  // namespace greenloop
