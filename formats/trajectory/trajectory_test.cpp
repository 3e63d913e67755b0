#include <doctest/doctest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/store/hdf5_handle.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/trajectory/trajectory_file.hpp"

namespace greenloop {
namespace {

TrajectoryScene small_scene() {
  TrajectoryScene scene;
  scene.time_step = 0.01;
  scene.rest = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  scene.triangles = {0, 1, 2, 2, 1, 3};
  scene.impulses = {{.name = "push", .initial = {1, 0, 0, 0}}, {.name = "pull", .initial = {-1, 0, 0, 0}}};
  scene.successions = {0, 1, 1, 0, 1, 1};
  scene.provenance = R"({"scene": "test"})";
  return scene;
}

/// Recognisable positions of a frame.
std::vector<float> frame_values(int frame) {
  std::vector<float> values = small_scene().rest;
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] += 0.25F * static_cast<float>(frame) + 0.01F * static_cast<float>(k);
  return values;
}

void add_orbit(TrajectoryWriter& writer, std::uint32_t impulse, int frames, std::int64_t previous, bool at_rest) {
  writer.begin_orbit(impulse, previous);
  for (int k = 0; k < frames; ++k) {
    const auto frame = static_cast<int>(writer.scene().orbits.empty() ? 0
                                                                      : writer.scene().orbits.back().first_frame +
                                                                            writer.scene().orbits.back().frames);
    writer.add_frame(frame_values(frame + k));
  }
  writer.end_orbit(at_rest);
}

/// Two orbits of five and four frames, in a file with more room.
void write_small(const std::filesystem::path& path) {
  auto writer = TrajectoryWriter::create(path, small_scene(), {.frames = 20, .orbits = 6});
  add_orbit(writer, 0, 5, -1, false);
  add_orbit(writer, 1, 4, 3, true);
  writer.close();
}

void check_small(const TrajectoryScene& scene) {
  const TrajectoryScene expected = small_scene();
  CHECK(scene.time_step == expected.time_step);
  CHECK(scene.rest == expected.rest);
  CHECK(scene.triangles == expected.triangles);
  CHECK(scene.successions == expected.successions);
  CHECK(scene.provenance == expected.provenance);
  REQUIRE(scene.impulses.size() == 2);
  CHECK(scene.impulses[1].name == "pull");
  CHECK(scene.impulses[1].initial == expected.impulses[1].initial);
  REQUIRE(scene.orbits.size() == 2);
  CHECK(scene.orbits[0] == TrajectoryOrbit{.first_frame = 0, .frames = 5, .impulse = 0});
  CHECK(scene.orbits[1] ==
        TrajectoryOrbit{.first_frame = 5, .frames = 4, .impulse = 1, .at_rest = true, .previous_frame = 3});
}

template <typename Error>
std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

void check_says(const std::string& message, const std::string& part) {
  CAPTURE(message);
  CHECK(message.find(part) != std::string::npos);
}

TEST_CASE("trajectories: what is written is read, in blocks") {
  const TemporaryFolder folder("trajectory");
  const auto path = folder.path() / "small.h5";
  write_small(path);
  const auto file = TrajectoryFile::open(path);
  check_small(file.scene());
  CHECK(file.frames() == 20);
  std::vector<float> positions(std::size_t{2} * 12);
  file.read_frames(6, 2, positions);
  const auto expected = frame_values(7);
  CHECK(std::vector<float>(positions.begin() + 12, positions.end()) == expected);
  CHECK_THROWS_AS(file.read_frames(19, 2, positions), std::runtime_error);
  CHECK_THROWS_AS(file.read_frames(~std::uint64_t{0}, 2, positions), std::runtime_error);
  CHECK_THROWS_AS(file.read_frames(0, 3, positions), std::invalid_argument);
}

TEST_CASE("trajectories: a writer goes on behind the last whole orbit, also after a kill") {
  const TemporaryFolder folder("trajectory-resume");
  const auto path = folder.path() / "killed.h5";
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {  // killed in the midst of its third orbit
    auto writer = TrajectoryWriter::create(path, small_scene(), {.frames = 20, .orbits = 6});
    add_orbit(writer, 0, 5, -1, false);
    add_orbit(writer, 1, 4, 3, true);
    writer.begin_orbit(0, 4);
    writer.add_frame(frame_values(100));
    (void)kill(getpid(), SIGKILL);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));

  auto writer = TrajectoryWriter::resume(path);
  check_small(writer.scene());
  CHECK(writer.room().frames == 11);
  CHECK(writer.room().orbits == 4);
  add_orbit(writer, 1, 3, 2, true);
  std::vector<float> positions(12);
  writer.read_frames(9, 1, positions);
  CHECK(positions == frame_values(9));
  writer.begin_orbit(0, -1);
  writer.add_frame(frame_values(0));
  writer.drop_orbit();
  CHECK(writer.room().frames == 8);
  writer.close();
  CHECK(TrajectoryFile::open(path).scene().orbits.size() == 3);
}

TEST_CASE("trajectories: misuse of a writer is refused") {
  const TemporaryFolder folder("trajectory-misuse");
  const auto path = folder.path() / "small.h5";
  auto writer = TrajectoryWriter::create(path, small_scene(), {.frames = 3, .orbits = 1});
  CHECK_THROWS_AS((void)TrajectoryWriter::create(path, small_scene(), {.frames = 3, .orbits = 1}), std::runtime_error);
  CHECK_THROWS_AS(writer.add_frame(frame_values(0)), std::invalid_argument);
  CHECK_THROWS_AS(writer.begin_orbit(2, -1), std::invalid_argument);
  CHECK_THROWS_AS(writer.begin_orbit(0, 0), std::invalid_argument);
  writer.begin_orbit(0, -1);
  CHECK_THROWS_AS(writer.begin_orbit(0, -1), std::invalid_argument);
  CHECK_THROWS_AS(writer.add_frame(std::vector<float>(11)), std::invalid_argument);
  CHECK_THROWS_AS(writer.add_frame(std::vector<float>(12, std::numeric_limits<float>::quiet_NaN())),
                  std::invalid_argument);
  CHECK(writer.add_frame(frame_values(0)) == 0);
  CHECK_THROWS_AS(writer.end_orbit(true), std::invalid_argument);
  CHECK(writer.add_frame(frame_values(1)) == 1);
  CHECK(writer.add_frame(frame_values(2)) == 2);
  CHECK_THROWS_AS(writer.add_frame(frame_values(3)), std::runtime_error);
  writer.end_orbit(true);
  CHECK_THROWS_AS(writer.begin_orbit(0, -1), std::runtime_error);
}

TEST_CASE("trajectories: a scene that cannot be is refused with its field") {
  const TemporaryFolder folder("trajectory-scene");
  const auto refusal = [&](const std::function<void(TrajectoryScene&)>& change) {
    TrajectoryScene scene = small_scene();
    change(scene);
    return message_of<std::invalid_argument>(
        [&] { (void)TrajectoryWriter::create(folder.path() / "no.h5", scene, {.frames = 3, .orbits = 1}); });
  };
  check_says(refusal([](auto& scene) { scene.time_step = 0; }), "time_step");
  check_says(refusal([](auto& scene) { scene.rest.pop_back(); }), "/rest");
  check_says(refusal([](auto& scene) { scene.rest[2] = std::numeric_limits<float>::quiet_NaN(); }), "/rest");
  check_says(refusal([](auto& scene) { scene.triangles[4] = 4; }), "/triangles[1] names vertex 4 of 4");
  check_says(refusal([](auto& scene) { scene.triangles.clear(); }), "/triangles");
  check_says(refusal([](auto& scene) { scene.impulses.clear(); }), "0 impulses");
  check_says(refusal([](auto& scene) { scene.impulses[1].name = "push"; }), "two impulses are named");
  check_says(refusal([](auto& scene) { scene.impulses[1].name = "a\nb"; }), "impulse 1");
  check_says(refusal([](auto& scene) { scene.impulses[0].persistent[3] = std::numeric_limits<double>::infinity(); }),
             "/impulses/persistent");
  check_says(refusal([](auto& scene) { scene.successions[0] = 2; }), "/impulses/successions");
  check_says(refusal([](auto& scene) { scene.orbits.emplace_back(); }), "/orbits/frames[0]");
  CHECK(!std::filesystem::exists(folder.path() / "no.h5"));
}

// Files that somebody made to do harm: the small file, changed through the library.

void check_refused(const std::function<void(hid_t)>& change, const std::string& object, const std::string& reason) {
  const TemporaryFolder folder("trajectory-hostile");
  const auto path = folder.path() / "hostile.h5";
  write_small(path);
  {
    Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    REQUIRE(file);
    change(file.get());
    REQUIRE(file.close());
  }
  const auto message = message_of<std::runtime_error>([&] { (void)TrajectoryFile::open(path); });
  check_says(message, object);
  check_says(message, reason);
  check_says(message_of<std::runtime_error>([&] { (void)TrajectoryWriter::resume(path); }), reason);
}

Hdf5Handle simple(const Hdf5Shape& shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose};
}

void replace_dataset(hid_t file, const char* name, hid_t type, const Hdf5Shape& shape, hid_t plist = H5P_DEFAULT) {
  REQUIRE(H5Ldelete(file, name, H5P_DEFAULT) >= 0);
  const Hdf5Handle space = simple(shape), stored(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  REQUIRE(H5Pset_alloc_time(stored.get(), H5D_ALLOC_TIME_EARLY) >= 0);
  if (plist == H5P_DEFAULT) plist = stored.get();
  const Hdf5Handle id(H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, plist, H5P_DEFAULT), H5Dclose);
  REQUIRE(id);
  const std::string unit = "m";
  const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose), one(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(H5Acreate2(id.get(), "unit", text.get(), one.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  REQUIRE(H5Awrite(attribute.get(), text.get(), unit.c_str()) >= 0);
}

void put(hid_t file, const char* name, const std::vector<std::int64_t>& values) {
  const Hdf5Handle id(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  REQUIRE(H5Dwrite(id.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
}

TEST_CASE("hostile trajectories: frames that are elsewhere, filtered, chunked, linked or of another shape") {
  const Hdf5Shape shape{20, 4, 3};
  const Hdf5Handle external(H5Pcreate(H5P_DATASET_CREATE), H5Pclose), chunked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Hdf5Handle filtered(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Hdf5Shape chunk{1, 4, 3};
  REQUIRE(H5Pset_external(external.get(), "elsewhere", 0, H5F_UNLIMITED) >= 0);
  REQUIRE(H5Pset_chunk(chunked.get(), 3, chunk.data()) >= 0);
  REQUIRE(H5Pset_chunk(filtered.get(), 3, chunk.data()) >= 0);
  REQUIRE(H5Pset_shuffle(filtered.get()) >= 0);
  const auto frames = [&](hid_t type, const Hdf5Shape& of, hid_t plist) {
    return [&, type, of, plist](hid_t file) { replace_dataset(file, "/frames", type, of, plist); };
  };
  check_refused(frames(H5T_IEEE_F32LE, shape, external.get()), "/frames", "external storage");
  check_refused(frames(H5T_IEEE_F32LE, shape, chunked.get()), "/frames", "chunked");
  check_refused(frames(H5T_IEEE_F32LE, shape, filtered.get()), "/frames", "filter");
  check_refused(frames(H5T_IEEE_F32LE, {20, 5, 3}, H5P_DEFAULT), "/frames", "must have the shape [frames, 4, 3]");
  check_refused(frames(H5T_IEEE_F32LE, {20, 12}, H5P_DEFAULT), "/frames", "must have the shape [frames, 4, 3]");
  check_refused(
      [](hid_t file) {
        REQUIRE(H5Ldelete(file, "/frames", H5P_DEFAULT) >= 0);
        REQUIRE(H5Lcreate_external("other.h5", "/frames", file, "/frames", H5P_DEFAULT, H5P_DEFAULT) >= 0);
      },
      "/frames", "link to another file");
  check_refused([](hid_t file) { REQUIRE(H5Ldelete(file, "/frames", H5P_DEFAULT) >= 0); }, "/frames", "is missing");
}

TEST_CASE("hostile trajectories: tables that do not fit one another or the frames") {
  check_refused([](hid_t file) { put(file, "/orbits/frames", {5, 16, 0, 0, 0, 0}); }, "/orbits/frames[1]", "16 frames");
  check_refused([](hid_t file) { put(file, "/orbits/frames", {5, 1, 0, 0, 0, 0}); }, "/orbits/frames[1]", "at least 2");
  check_refused([](hid_t file) { put(file, "/orbits/first_frame", {0, -5, 0, 0, 0, 0}); }, "/orbits", "negative");
  check_refused(
      [](hid_t file) {
        put(file, "/orbits/first_frame", {0, INT64_MAX, 0, 0, 0, 0});
      },
      "/orbits/frames[1]", "at least 2");
  check_refused(
      [](hid_t file) {
        put(file, "/orbits/impulse", {0, INT64_MAX, 0, 0, 0, 0});
      },
      "/orbits/impulse[1]", "2 impulses");
  check_refused(
      [](hid_t file) {
        put(file, "/orbits/previous_frame", {-1, 20, 0, 0, 0, 0});
      },
      "/orbits/previous_frame[1]", "-1");
  check_refused([](hid_t file) { put(file, "/orbits/done", {1, 3, 0, 0, 0, 0}); }, "/orbits/done", "not only 0, 1");
  check_refused(
      [](hid_t file) {
        replace_dataset(file, "/impulses/initial", H5T_IEEE_F64LE, {3, 4});
      },
      "/impulses/initial", "must have the shape [2, 4]");
  const Hdf5Handle unwritten(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  check_refused(
      [&](hid_t file) {
        replace_dataset(file, "/triangles", H5T_STD_U32LE, {1U << 30, 3}, unwritten.get());
      },
      "/triangles", "its shape asks for other values");
  check_refused(
      [](hid_t file) {
        replace_dataset(file, "/triangles", H5T_IEEE_F64LE, {2, 3});
      },
      "/triangles", "integers");
}

TEST_CASE("hostile trajectories: frames beyond the end of the file, and values that are none") {
  const TemporaryFolder folder("trajectory-cut");
  const auto path = folder.path() / "cut.h5";
  write_small(path);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 64);
  check_says(message_of<std::runtime_error>([&] { (void)TrajectoryFile::open(path); }), "cut.h5");

  const auto wrong = folder.path() / "nan.h5";
  write_small(wrong);
  {
    const Hdf5Handle file(H5Fopen(wrong.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const Hdf5Handle id(H5Dopen2(file.get(), "/frames", H5P_DEFAULT), H5Dclose);
    const std::vector<float> values(20 * 12, std::numeric_limits<float>::quiet_NaN());
    REQUIRE(H5Dwrite(id.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
  }
  std::vector<float> positions(24);
  const auto file = TrajectoryFile::open(wrong);
  check_says(message_of<std::runtime_error>([&] { file.read_frames(2, 2, positions); }), "frame 2");
}

}  // namespace
}  // namespace greenloop
