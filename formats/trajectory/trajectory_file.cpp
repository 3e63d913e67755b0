#include "formats/trajectory/trajectory_file.hpp"

#include <utility>

#include "formats/trajectory/trajectory_scene.hpp"

namespace greenloop {

struct TrajectoryFile::File {
  Hdf5File hdf5;
  TrajectoryScene scene;
  std::uint64_t frames;
};

TrajectoryFile::TrajectoryFile(std::unique_ptr<File> file) : file_(std::move(file)) {}
TrajectoryFile::~TrajectoryFile() = default;
TrajectoryFile::TrajectoryFile(TrajectoryFile&&) noexcept = default;
TrajectoryFile& TrajectoryFile::operator=(TrajectoryFile&&) noexcept = default;

TrajectoryFile TrajectoryFile::open(const std::filesystem::path& path) {
  auto hdf5 = open_trajectories(path, false);
  auto scene = read_scene(hdf5);
  const std::uint64_t frames = frame_room(hdf5, scene);
  return TrajectoryFile(std::unique_ptr<File>(new File{std::move(hdf5), std::move(scene), frames}));
}

const std::filesystem::path& TrajectoryFile::path() const { return file_->hdf5.path(); }
const TrajectoryScene& TrajectoryFile::scene() const { return file_->scene; }
std::uint64_t TrajectoryFile::frames() const { return file_->frames; }

void TrajectoryFile::read_frames(std::uint64_t first, std::uint64_t count, std::span<float> positions) const {
  read_finite_frames(file_->hdf5, file_->scene, file_->frames, first, count, positions);
}

}  // namespace greenloop
