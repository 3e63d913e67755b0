#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/output/output_file.hpp"
#include "formats/trajectory/trajectory_file.hpp"
#include "formats/trajectory/trajectory_scene.hpp"

namespace greenloop {
namespace {

[[noreturn]] void misuse(const std::string& what) { throw std::invalid_argument("trajectories: " + what); }

void require_room(const TrajectoryScene& scene, TrajectoryRoom room) {
  if (!scene.orbits.empty()) misuse("a new file has no orbits yet");
  const std::uint64_t most = std::numeric_limits<std::int64_t>::max() / (scene.rest.size() * sizeof(float));
  if (room.frames < 2 || room.frames > most) misuse("room for " + std::to_string(room.frames) + " frames is asked for");
  if (room.orbits < 1 || room.orbits > room.frames) {
    misuse("room for " + std::to_string(room.orbits) + " orbits is asked for, of " + std::to_string(room.frames) +
           " frames");
  }
}

/// All of it but orbits and frames: from here on only the values of datasets change.
Hdf5File new_file(const std::filesystem::path& path, const TrajectoryScene& scene, TrajectoryRoom room) {
  PendingFile unfinished(path, true, ".h5.part");
  auto hdf5 = Hdf5File::create(unfinished.name(), kTrajectoryDocument);
  write_scene(hdf5, scene);
  reserve_orbits(hdf5, room.orbits);
  hdf5.reserve<float>(kFrames, {room.frames, scene.vertices(), 3});
  hdf5.write_text(kFrames, "unit", "m");
  hdf5.flush();
  if (!unfinished.publish_new()) {
    throw std::runtime_error(path.string() + ": stands there already; go on with it, or name another file");
  }
  hdf5.renamed(path);
  return hdf5;
}

std::uint64_t end_of(const std::vector<TrajectoryOrbit>& orbits) {
  std::uint64_t end = 0;
  for (const TrajectoryOrbit& orbit : orbits) end = std::max(end, orbit.first_frame + orbit.frames);
  return end;
}

}  // namespace

struct TrajectoryWriter::File {
  Hdf5File hdf5;
  TrajectoryScene scene;
  TrajectoryRoom room;       // of the whole file
  std::uint64_t frames = 0;  // behind the last one, begun orbit and all
  std::optional<TrajectoryOrbit> begun = {};

  TrajectoryOrbit& begun_orbit() {
    if (!begun) misuse("no orbit has begun");
    return *begun;
  }
};

TrajectoryWriter::TrajectoryWriter(std::unique_ptr<File> file) : file_(std::move(file)) {}
TrajectoryWriter::~TrajectoryWriter() = default;
TrajectoryWriter::TrajectoryWriter(TrajectoryWriter&&) noexcept = default;
TrajectoryWriter& TrajectoryWriter::operator=(TrajectoryWriter&&) noexcept = default;

TrajectoryWriter TrajectoryWriter::create(const std::filesystem::path& path, const TrajectoryScene& scene,
                                          TrajectoryRoom room) {
  require_valid(scene, 0);
  require_room(scene, room);
  return TrajectoryWriter(std::unique_ptr<File>(new File{new_file(path, scene, room), scene, room}));
}

TrajectoryWriter TrajectoryWriter::resume(const std::filesystem::path& path) {
  auto hdf5 = open_trajectories(path, true);
  auto scene = read_scene(hdf5);
  const TrajectoryRoom room{.frames = frame_room(hdf5, scene), .orbits = orbit_room(hdf5)};
  const std::uint64_t frames = end_of(scene.orbits);
  return TrajectoryWriter(std::unique_ptr<File>(new File{std::move(hdf5), std::move(scene), room, frames}));
}

const TrajectoryScene& TrajectoryWriter::scene() const { return file_->scene; }

TrajectoryRoom TrajectoryWriter::room() const {
  return {.frames = file_->room.frames - file_->frames, .orbits = file_->room.orbits - file_->scene.orbits.size()};
}

void TrajectoryWriter::begin_orbit(std::uint32_t impulse, std::int64_t previous_frame, bool held_out) {
  if (file_->begun) misuse("the orbit before has not ended");
  if (impulse >= file_->scene.impulses.size()) misuse("there is no impulse " + std::to_string(impulse));
  if (previous_frame < -1 || previous_frame >= static_cast<std::int64_t>(file_->frames)) {
    misuse("there is no previous frame " + std::to_string(previous_frame));
  }
  if (room().orbits == 0) file_->hdf5.fail("/orbits", "has no room for another one");
  file_->begun = TrajectoryOrbit{
      .first_frame = file_->frames, .impulse = impulse, .previous_frame = previous_frame, .held_out = held_out};
}

std::uint64_t TrajectoryWriter::add_frame(std::span<const float> positions) {
  TrajectoryOrbit& orbit = file_->begun_orbit();
  if (positions.size() != file_->scene.rest.size()) {
    misuse("a frame of " + std::to_string(positions.size()) + " numbers; " + std::to_string(file_->scene.rest.size()) +
           " are wanted");
  }
  if (!std::all_of(positions.begin(), positions.end(), [](float x) { return std::isfinite(x); })) {
    misuse("frame " + std::to_string(file_->frames) + " holds values that are not finite");
  }
  if (room().frames == 0) file_->hdf5.fail(kFrames, "has no room for another one");
  file_->hdf5.write_part(kFrames, {file_->frames, 0, 0}, {1, file_->scene.vertices(), 3}, positions.data());
  ++orbit.frames;
  return file_->frames++;
}

void TrajectoryWriter::end_orbit(bool at_rest) {
  TrajectoryOrbit& orbit = file_->begun_orbit();
  if (orbit.frames < 2) misuse("an orbit has two frames at least");
  orbit.at_rest = at_rest;
  const std::uint64_t index = file_->scene.orbits.size();
  write_orbit(file_->hdf5, index, orbit);
  file_->hdf5.flush();
  mark_done(file_->hdf5, index);
  file_->hdf5.flush();
  file_->scene.orbits.push_back(orbit);
  file_->begun.reset();
}

void TrajectoryWriter::drop_orbit() {
  file_->frames = file_->begun_orbit().first_frame;
  file_->begun.reset();
}

void TrajectoryWriter::read_frames(std::uint64_t first, std::uint64_t count, std::span<float> positions) const {
  read_finite_frames(file_->hdf5, file_->scene, file_->frames, first, count, positions);
}

void TrajectoryWriter::close() { file_->hdf5.close(); }

}  // namespace greenloop
