// Measures what docs/results/impulses.md states of the reduction: greenloop-reduce-bench FILE.h5 VERTICES FRAMES [MB]
// writes trajectories of that size if there is no such file, then reads it and reduces it in so many megabytes (512).
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <vector>

#include "formats/trajectory/trajectory_file.hpp"
#include "offline/reduce/frame_stream.hpp"
#include "offline/reduce/reduced_frames.hpp"

namespace {

using namespace greenloop;
using namespace greenloop::offline;

constexpr int waves = 24;  // in the motion, each half as large again as the next

/// What something took: on the wall, and of processors.
struct Taken {
  double wall = 0, processor = 0;
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

Taken so_far() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
          seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

Taken since(const Taken& begin) {
  const Taken end = so_far();
  return {end.wall - begin.wall, end.processor - begin.processor};
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Waves that travel along a strip, and rounding noise.
void write_strip(const std::filesystem::path& path, std::uint64_t vertices, std::uint64_t frames) {
  TrajectoryScene scene;
  scene.time_step = 0.01;
  for (std::uint64_t v = 0; v < vertices; ++v) {
    for (const float x : {static_cast<float>(v) / static_cast<float>(vertices), 0.0F, 0.0F}) scene.rest.push_back(x);
  }
  scene.triangles = {0, 1, 2};
  scene.impulses = {{.name = "shake"}};
  scene.successions = {1, 1};
  auto writer = TrajectoryWriter::create(path, scene, {.frames = frames, .orbits = 1});
  std::vector<float> shape(waves * scene.rest.size());
  for (int w = 0; w < waves; ++w) {
    for (std::size_t k = 0; k < scene.rest.size(); ++k) {
      shape[w * scene.rest.size() + k] = std::sin(0.37F * static_cast<float>(w + 1) * static_cast<float>(k % 7 + 1) +
                                                  6.0F * static_cast<float>(w + 1) * scene.rest[k - k % 3]);
    }
  }
  writer.begin_orbit(0, -1);
  std::vector<float> frame(scene.rest.size());
  for (std::uint64_t f = 0; f < frames; ++f) {
    frame = scene.rest;
    for (int w = 0; w < waves; ++w) {
      const float now = 0.1F * std::pow(0.67F, static_cast<float>(w)) *
                        std::sin(0.01F * static_cast<float>(f) * static_cast<float>(w + 3));
      for (std::size_t k = 0; k < frame.size(); ++k) frame[k] += now * shape[w * frame.size() + k];
    }
    writer.add_frame(frame);
  }
  writer.end_orbit(true);
  writer.close();
}

Taken time_to_read(const TrajectoryFile& file) {
  const Taken begin = so_far();
  stream_frames(file, {{0, file.frames()}}, 64, [](std::uint64_t, Eigen::Ref<Eigen::MatrixXf>) {});
  return since(begin);
}

int measure(int count, char** arguments) {
  const std::filesystem::path path = arguments[1];
  const std::uint64_t vertices = std::strtoull(arguments[2], nullptr, 10);
  const std::uint64_t frames = std::strtoull(arguments[3], nullptr, 10);
  if (!std::filesystem::exists(path)) write_strip(path, vertices, frames);
  ReductionGoal goal;
  if (count > 4) goal.memory = std::strtoull(arguments[4], nullptr, 10) << 20U;
  const auto file = TrajectoryFile::open(path);
  const Taken reading = time_to_read(file);
  const Taken begin = so_far();
  const auto reduced = reduce_frames(file, {{0, file.frames()}}, goal, [](double) {});
  const Taken reducing = since(begin);
  std::printf(
      "%.2f GB: read in %.1f s (processors %.1f s), reduced in %.1f s (%.1f s): %.2f times (%.2f); peak %.0f MB\n",
      static_cast<double>(std::filesystem::file_size(path)) / 1e9, reading.wall, reading.processor, reducing.wall,
      reducing.processor, reducing.wall / reading.wall, reducing.processor / reading.processor, peak_megabytes());
  std::printf("%td modes, unread %.2e sigma_1\n", reduced.modes.cols(),
              reduced.unread / reduced.singular_values.front());
  return 0;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 4) {
    std::fprintf(stderr, "usage: greenloop-reduce-bench FILE.h5 VERTICES FRAMES [MB]\n");
    return 2;
  }
  return measure(count, arguments);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
