#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace greenloop {

// Simulated motions of a scene in HDF5, from any program (docs/trajectories.md). Frames are positions of all vertices.
// An *orbit* is a sequence of frames that an impulse began: its first frame is the state that the impulse met, the
// second the first that shows what it does.

/// An impulse of the palette, as the scene means it (James & Fatahalian 2003, section 3.3).
struct Impulse {
  std::string name;
  std::array<double, 4> initial{};     ///< alpha^I, in the first step
  std::array<double, 4> persistent{};  ///< alpha^F, in all others
};

struct TrajectoryOrbit {
  std::uint64_t first_frame = 0;
  std::uint64_t frames = 0;          ///< >= 2
  std::uint32_t impulse = 0;         ///< of the palette
  bool at_rest = false;              ///< whether it has come to rest in its last frame
  std::int64_t previous_frame = -1;  ///< the frame before its first one, in the orbit that it interrupts; -1: at rest
  bool held_out = false;             ///< kept from the model: replay is measured on it

  bool operator==(const TrajectoryOrbit&) const = default;
};

/// All that a file says but for the frames themselves.
struct TrajectoryScene {
  double time_step = 0;                  ///< s, between two frames
  std::vector<float> rest;               ///< m, [vertices][3]: the scene at rest, where every motion begins and ends
  std::vector<std::uint32_t> triangles;  ///< [triangles][3], of what is shown
  std::vector<Impulse> impulses;
  std::vector<std::uint8_t>
      successions;  ///< [impulses + 1][impulses]: 1 if the second may follow the first; last: at rest
  std::vector<TrajectoryOrbit> orbits;
  std::string provenance;  ///< JSON

  [[nodiscard]] std::size_t vertices() const { return rest.size() / 3; }
};

/// A file to read. Nothing in it is believed: see Hdf5File; types, shapes, indices and the scene are checked when it is
/// opened, frames when they are read. Every error is a std::runtime_error that names file and dataset.
class TrajectoryFile {
 public:
  static TrajectoryFile open(const std::filesystem::path& path);
  ~TrajectoryFile();
  TrajectoryFile(TrajectoryFile&&) noexcept;
  TrajectoryFile& operator=(TrajectoryFile&&) noexcept;

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] const TrajectoryScene& scene() const;
  /// Of the file; its orbits may cover fewer.
  [[nodiscard]] std::uint64_t frames() const;

  /// Frames first .. first + count - 1, m, to [count][vertices][3]. Throws unless they stand in the file, all finite;
  /// std::invalid_argument unless `positions` has their size. Work: one read; nothing is kept.
  void read_frames(std::uint64_t first, std::uint64_t count, std::span<float> positions) const;

 private:
  struct File;
  explicit TrajectoryFile(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

/// The most that a file will hold: its room is reserved at once, so that a kill at any time leaves it readable. What is
/// not written takes no room on file systems that know holes.
struct TrajectoryRoom {
  std::uint64_t frames = 0;
  std::uint64_t orbits = 0;
};

/// Appends orbits, frame by frame. An orbit counts from end_orbit() on; one that was begun when the process was killed
/// is written over.
class TrajectoryWriter {
 public:
  /// A new file, in the place of none. `scene` has no orbits yet. Throws std::invalid_argument naming the field of the
  /// scene that is wrong, std::runtime_error if something stands under that name already or there is no room.
  static TrajectoryWriter create(const std::filesystem::path& path, const TrajectoryScene& scene, TrajectoryRoom room);
  /// Goes on behind the last whole orbit. Throws std::runtime_error as TrajectoryFile does. The scene of the file is to
  /// be compared with the wanted one by its user.
  static TrajectoryWriter resume(const std::filesystem::path& path);
  ~TrajectoryWriter();
  TrajectoryWriter(TrajectoryWriter&&) noexcept;
  TrajectoryWriter& operator=(TrajectoryWriter&&) noexcept;

  /// With the orbits that are whole.
  [[nodiscard]] const TrajectoryScene& scene() const;
  /// What is left of the room.
  [[nodiscard]] TrajectoryRoom room() const;

  /// Its frames follow. `previous_frame` as in TrajectoryOrbit. Throws std::invalid_argument if the last one has not
  /// ended, or unless the impulse and the frame exist.
  void begin_orbit(std::uint32_t impulse, std::int64_t previous_frame, bool held_out = false);
  /// m, [vertices][3]. Throws std::invalid_argument for another size or what is not finite, std::runtime_error when the
  /// room is used up or the disk is full. Returns its number, to be another orbit's `previous_frame`.
  std::uint64_t add_frame(std::span<const float> positions);
  /// Two frames at least. It is on the disk when this returns.
  void end_orbit(bool at_rest);
  /// Leaves out what was added since begin_orbit().
  void drop_orbit();

  /// Of whole orbits and of the begun one; as TrajectoryFile::read_frames.
  void read_frames(std::uint64_t first, std::uint64_t count, std::span<float> positions) const;

  /// Throws if something was lost; the writer is not to be used afterwards. Whole orbits are safe without.
  void close();

 private:
  struct File;
  explicit TrajectoryWriter(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

}  // namespace greenloop
