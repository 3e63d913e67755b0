#include "formats/trajectory/trajectory_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace greenloop {
namespace {

constexpr std::size_t most_impulses = 64;
constexpr std::size_t longest_name = 31;
constexpr std::uint64_t most_vertices = std::uint64_t{1} << 24;

constexpr const char* kRest = "/rest";
constexpr const char* kTriangles = "/triangles";
constexpr const char* kImpulses = "/impulses";
constexpr const char* kInitial = "/impulses/initial";
constexpr const char* kPersistent = "/impulses/persistent";
constexpr const char* kSuccessions = "/impulses/successions";
constexpr const char* kFirstFrame = "/orbits/first_frame";
constexpr const char* kOrbitFrames = "/orbits/frames";
constexpr const char* kImpulse = "/orbits/impulse";
constexpr const char* kAtRest = "/orbits/at_rest";
constexpr const char* kPreviousFrame = "/orbits/previous_frame";
constexpr const char* kHeldOut = "/orbits/held_out";
constexpr const char* kDone = "/orbits/done";

[[noreturn]] void reject(const std::string& what) { throw std::invalid_argument("trajectories: " + what); }

std::string indexed(const char* dataset, std::size_t index) {
  return std::string(dataset) + "[" + std::to_string(index) + "]";
}

template <typename Values>
void require_finite(const char* dataset, const Values& values) {
  for (const auto value : values) {
    if (!std::isfinite(value)) reject(std::string(dataset) + " holds values that are not finite");
  }
}

void require_mesh(const TrajectoryScene& scene) {
  if (scene.rest.empty() || scene.rest.size() % 3 != 0)
    reject("/rest needs three numbers for each vertex, of one at least");
  if (scene.vertices() > most_vertices) reject("/rest has more than " + std::to_string(most_vertices) + " vertices");
  require_finite(kRest, scene.rest);
  if (scene.triangles.empty() || scene.triangles.size() % 3 != 0) {
    reject("/triangles needs three vertices for each triangle, of one at least");
  }
  for (std::size_t k = 0; k < scene.triangles.size(); ++k) {
    if (scene.triangles[k] < scene.vertices()) continue;
    reject(indexed(kTriangles, k / 3) + " names vertex " + std::to_string(scene.triangles[k]) + " of " +
           std::to_string(scene.vertices()));
  }
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= longest_name &&
         std::all_of(name.begin(), name.end(), [](char letter) { return letter >= ' ' && letter <= '~'; });
}

void require_impulses(const TrajectoryScene& scene) {
  const std::size_t count = scene.impulses.size();
  if (count == 0 || count > most_impulses) {
    reject("there are " + std::to_string(count) + " impulses; 1 to " + std::to_string(most_impulses) + " are wanted");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Impulse& impulse = scene.impulses[i];
    if (!is_name(impulse.name)) {
      reject("impulse " + std::to_string(i) + " needs a name of 1 to 31 printable ASCII letters");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (scene.impulses[k].name == impulse.name) reject("two impulses are named \"" + impulse.name + "\"");
    }
    require_finite(kInitial, impulse.initial);
    require_finite(kPersistent, impulse.persistent);
  }
  if (scene.successions.size() != (count + 1) * count)
    reject("/impulses/successions must have the shape [impulses + 1, impulses]");
  if (std::any_of(scene.successions.begin(), scene.successions.end(), [](auto legal) { return legal > 1; })) {
    reject("/impulses/successions holds not only 0, 1");
  }
}

void require_orbits(const TrajectoryScene& scene, std::uint64_t frames) {
  for (std::size_t k = 0; k < scene.orbits.size(); ++k) {
    const TrajectoryOrbit& orbit = scene.orbits[k];
    if (orbit.frames < 2 || orbit.frames > frames || orbit.first_frame > frames - orbit.frames) {
      reject(indexed(kOrbitFrames, k) + ": " + std::to_string(orbit.frames) + " frames from " +
             std::to_string(orbit.first_frame) + "; at least 2 of the file's " + std::to_string(frames) +
             " are wanted");
    }
    if (orbit.impulse >= scene.impulses.size()) {
      reject(indexed(kImpulse, k) + " is " + std::to_string(orbit.impulse) + "; there are " +
             std::to_string(scene.impulses.size()) + " impulses");
    }
    if (orbit.previous_frame < -1 || orbit.previous_frame >= static_cast<std::int64_t>(frames)) {
      reject(indexed(kPreviousFrame, k) + " is " + std::to_string(orbit.previous_frame) +
             "; a frame of the file is wanted, or -1 if the orbit begins at rest");
    }
  }
}

std::string joined_names(const std::vector<Impulse>& impulses) {
  std::string text;
  for (const Impulse& impulse : impulses) text += (text.empty() ? "" : "\n") + impulse.name;
  return text;
}

std::vector<Impulse> named_impulses(const std::string& names) {
  std::vector<Impulse> impulses;
  for (std::size_t begin = 0; begin <= names.size() && impulses.size() <= most_impulses;) {
    const std::size_t end = std::min(names.find('\n', begin), names.size());
    impulses.push_back({.name = names.substr(begin, end - begin)});
    begin = end + 1;
  }
  return impulses;
}

// `any` stands for a length that nothing else says
constexpr hsize_t any = ~hsize_t{0};

template <typename Number>
std::vector<Number> read_shaped(const Hdf5File& file, const char* dataset, const Hdf5Shape& wanted) {
  Hdf5Shape found = file.shape(dataset);
  bool fits = found.size() == wanted.size();
  for (std::size_t axis = 0; fits && axis < wanted.size(); ++axis) {
    fits = wanted[axis] == any || found[axis] == wanted[axis];
  }
  if (!fits) {
    std::string shape;
    for (const hsize_t extent : wanted) {
      shape += (shape.empty() ? "" : ", ") + (extent == any ? std::string("count") : std::to_string(extent));
    }
    file.fail(dataset, "must have the shape [" + shape + "]");
  }
  return file.read<Number>(dataset, found);
}

void require_metres(const Hdf5File& file, const char* dataset) {
  const std::string unit = file.read_text(dataset, "unit");
  if (unit != "m") file.fail(dataset, "its unit is '" + unit + "', convert it to 'm'");
}

void read_impulses(const Hdf5File& file, TrajectoryScene& scene) {
  scene.impulses = named_impulses(file.read_text(kImpulses, "names"));
  const hsize_t count = scene.impulses.size();
  const auto initial = read_shaped<double>(file, kInitial, {count, 4});
  const auto persistent = read_shaped<double>(file, kPersistent, {count, 4});
  for (std::size_t k = 0; k < initial.size(); ++k) {
    scene.impulses[k / 4].initial[k % 4] = initial[k];
    scene.impulses[k / 4].persistent[k % 4] = persistent[k];
  }
  scene.successions = read_shaped<unsigned char>(file, kSuccessions, {count + 1, count});
}

std::vector<unsigned char> read_flags(const Hdf5File& file, const char* dataset, hsize_t count, bool otherwise) {
  if (!file.has(dataset)) return std::vector<unsigned char>(count, otherwise ? 1 : 0);
  auto flags = read_shaped<unsigned char>(file, dataset, {count});
  if (std::any_of(flags.begin(), flags.end(), [](auto flag) { return flag > 1; })) {
    file.fail(dataset, "holds not only 0, 1");
  }
  return flags;
}

void read_orbits(const Hdf5File& file, TrajectoryScene& scene) {
  const auto first = read_shaped<std::int64_t>(file, kFirstFrame, {any});
  const hsize_t count = first.size();
  const auto frames = read_shaped<std::int64_t>(file, kOrbitFrames, {count});
  const auto impulse = read_shaped<std::int64_t>(file, kImpulse, {count});
  const auto previous = read_shaped<std::int64_t>(file, kPreviousFrame, {count});
  const auto at_rest = read_flags(file, kAtRest, count, false);
  const auto held_out = read_flags(file, kHeldOut, count, false);
  const auto done = read_flags(file, kDone, count, true);
  for (std::size_t k = 0; k < count && done[k] != 0; ++k) {
    if (first[k] < 0 || frames[k] < 0 || impulse[k] < 0)
      file.fail("/orbits", "entry " + std::to_string(k) + " is negative");
    scene.orbits.push_back({.first_frame = static_cast<std::uint64_t>(first[k]),
                            .frames = static_cast<std::uint64_t>(frames[k]),
                            .impulse = static_cast<std::uint32_t>(std::min<std::int64_t>(impulse[k], most_impulses)),
                            .at_rest = at_rest[k] != 0,
                            .previous_frame = previous[k],
                            .held_out = held_out[k] != 0});
  }
}

}  // namespace

void require_valid(const TrajectoryScene& scene, std::uint64_t frames) {
  if (!(scene.time_step > 0) || !std::isfinite(scene.time_step)) reject("time_step must be positive, in s");
  require_mesh(scene);
  require_impulses(scene);
  require_orbits(scene, frames);
}

void write_scene(Hdf5File& file, const TrajectoryScene& scene) {
  file.write_text("/", "format", "greenloop trajectories");
  file.write_number("/", "format_version", kTrajectoryVersion);
  file.write_number("/", "time_step", scene.time_step);
  file.write_text("/", "time_unit", "s");
  file.write_text("/", "provenance", scene.provenance);
  file.write(kRest, {scene.vertices(), 3}, scene.rest);
  file.write_text(kRest, "unit", "m");
  file.write(kTriangles, {scene.triangles.size() / 3, 3}, scene.triangles);
  file.make_group(kImpulses);
  file.write_text(kImpulses, "names", joined_names(scene.impulses));
  std::vector<double> initial, persistent;
  for (const Impulse& impulse : scene.impulses) {
    initial.insert(initial.end(), impulse.initial.begin(), impulse.initial.end());
    persistent.insert(persistent.end(), impulse.persistent.begin(), impulse.persistent.end());
  }
  const hsize_t count = scene.impulses.size();
  file.write(kInitial, {count, 4}, initial);
  file.write(kPersistent, {count, 4}, persistent);
  file.write(kSuccessions, {count + 1, count}, scene.successions);
}

TrajectoryScene read_scene(const Hdf5File& file) {
  if (file.read_text("/", "format") != "greenloop trajectories") {
    file.fail("/", "the attribute 'format' names another format");
  }
  if (const double version = file.read_number("/", "format_version"); version != kTrajectoryVersion) {
    file.fail("/", "format_version " + std::to_string(version) + " is not " + std::to_string(kTrajectoryVersion));
  }
  TrajectoryScene scene;
  scene.time_step = file.read_number("/", "time_step");
  if (file.read_text("/", "time_unit") != "s") file.fail("/", "time_unit must be 's'");
  if (file.has_attribute("/", "provenance")) scene.provenance = file.read_text("/", "provenance");
  require_metres(file, kRest);
  scene.rest = read_shaped<float>(file, kRest, {any, 3});
  scene.triangles = read_shaped<std::uint32_t>(file, kTriangles, {any, 3});
  read_impulses(file, scene);
  read_orbits(file, scene);
  try {
    require_valid(scene, frame_room(file, scene));
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file.path().string() + ": " + error.what());
  }
  return scene;
}

void reserve_orbits(Hdf5File& file, std::uint64_t orbits) {
  file.make_group("/orbits");
  for (const char* dataset : {kFirstFrame, kOrbitFrames, kImpulse, kPreviousFrame}) {
    file.write(dataset, {orbits}, std::vector<std::int64_t>(orbits, 0));
  }
  for (const char* dataset : {kAtRest, kHeldOut, kDone}) {
    file.write(dataset, {orbits}, std::vector<unsigned char>(orbits, 0));
  }
}

std::uint64_t orbit_room(const Hdf5File& file) {
  if (!file.has(kDone)) file.fail(kDone, "is missing: the file was made whole elsewhere, and takes no more orbits");
  return file.shape(kDone).at(0);
}

void write_orbit(Hdf5File& file, std::uint64_t index, const TrajectoryOrbit& orbit) {
  const auto put = [&](const char* dataset, std::int64_t value) { file.write_part(dataset, {index}, {1}, &value); };
  const auto put_flag = [&](const char* dataset, bool value) {
    const unsigned char flag = value ? 1 : 0;
    file.write_part(dataset, {index}, {1}, &flag);
  };
  put(kFirstFrame, static_cast<std::int64_t>(orbit.first_frame));
  put(kOrbitFrames, static_cast<std::int64_t>(orbit.frames));
  put(kImpulse, orbit.impulse);
  put(kPreviousFrame, orbit.previous_frame);
  put_flag(kAtRest, orbit.at_rest);
  put_flag(kHeldOut, orbit.held_out);
}

void mark_done(Hdf5File& file, std::uint64_t index) {
  const unsigned char done = 1;
  file.write_part(kDone, {index}, {1}, &done);
}

std::uint64_t frame_room(const Hdf5File& file, const TrajectoryScene& scene) {
  require_metres(file, kFrames);
  const Hdf5Shape shape = file.shape(kFrames);
  if (shape.size() != 3 || shape[1] != scene.vertices() || shape[2] != 3) {
    file.fail(kFrames, "must have the shape [frames, " + std::to_string(scene.vertices()) + ", 3]");
  }
  return shape[0];
}

void read_finite_frames(const Hdf5File& file, const TrajectoryScene& scene, std::uint64_t end, std::uint64_t first,
                        std::uint64_t count, std::span<float> positions) {
  if (first > end || count > end - first) {
    file.fail(kFrames, "frames " + std::to_string(first) + " to " + std::to_string(first + count) + " of " +
                           std::to_string(end) + " are not there");
  }
  const std::size_t size = scene.rest.size();
  if (positions.size() != count * size) {
    throw std::invalid_argument("frames: room for " + std::to_string(count) + " of " + std::to_string(size) +
                                " numbers is wanted");
  }
  if (count == 0) return;
  file.read_part(kFrames, {first, 0, 0}, {count, scene.vertices(), 3}, positions.data());
  const auto wrong = std::find_if(positions.begin(), positions.end(), [](float x) { return !std::isfinite(x); });
  if (wrong != positions.end()) {
    const auto frame = first + static_cast<std::uint64_t>(wrong - positions.begin()) / size;
    file.fail(kFrames, "frame " + std::to_string(frame) + " holds values that are not finite");
  }
}

Hdf5File open_trajectories(const std::filesystem::path& path, bool writable) {
  auto file = Hdf5File::open(path, writable, kTrajectoryDocument);
  file.require_apart({kRest, kTriangles, kInitial, kPersistent, kSuccessions, kFirstFrame, kOrbitFrames, kImpulse,
                      kAtRest, kPreviousFrame, kHeldOut, kDone, kFrames});
  return file;
}

}  // namespace greenloop
