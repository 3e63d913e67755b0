#include "offline/reduce/frame_stream.hpp"

#include <algorithm>
#include <future>
#include <numeric>
#include <span>

namespace greenloop::offline {
namespace {

std::vector<FrameRange> blocks_of(const std::vector<FrameRange>& ranges, std::uint64_t block) {
  std::vector<FrameRange> blocks;
  for (const FrameRange& range : ranges) {
    for (std::uint64_t begin = 0; begin < range.count; begin += block) {
      blocks.push_back({range.first + begin, std::min(block, range.count - begin)});
    }
  }
  return blocks;
}

void read_displacements(const TrajectoryFile& file, const FrameRange& range, Eigen::MatrixXf& into) {
  const auto size = static_cast<Eigen::Index>(file.scene().rest.size());
  const auto count = static_cast<Eigen::Index>(range.count);
  file.read_frames(range.first, range.count, std::span(into.data(), static_cast<std::size_t>(size * count)));
  into.leftCols(count).colwise() -= Eigen::Map<const Eigen::VectorXf>(file.scene().rest.data(), size);
}

}  // namespace

std::vector<FrameRange> joined_ranges(std::vector<FrameRange> ranges) {
  std::sort(ranges.begin(), ranges.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<FrameRange> joined;
  for (const FrameRange& range : ranges) {
    if (joined.empty() || range.first > joined.back().first + joined.back().count) {
      joined.push_back(range);
    } else {
      FrameRange& last = joined.back();
      last.count = std::max(last.count, range.first + range.count - last.first);
    }
  }
  return joined;
}

std::uint64_t frame_count(const std::vector<FrameRange>& ranges) {
  return std::accumulate(ranges.begin(), ranges.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const FrameRange& range) { return sum + range.count; });
}

void stream_frames(const TrajectoryFile& file, const std::vector<FrameRange>& ranges, std::uint64_t block,
                   const std::function<void(std::uint64_t, Eigen::Ref<Eigen::MatrixXf>)>& use) {
  const auto blocks = blocks_of(ranges, block);
  const auto size = static_cast<Eigen::Index>(file.scene().rest.size());
  Eigen::MatrixXf now(size, static_cast<Eigen::Index>(block)), next(size, static_cast<Eigen::Index>(block));
  if (!blocks.empty()) read_displacements(file, blocks.front(), now);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    std::future<void> reading;
    if (k + 1 < blocks.size()) {
      reading = std::async(std::launch::async, [&, k] { read_displacements(file, blocks[k + 1], next); });
    }
    use(blocks[k].first, now.leftCols(static_cast<Eigen::Index>(blocks[k].count)));
    if (reading.valid()) reading.get();
    now.swap(next);
  }
}

}  // namespace greenloop::offline
