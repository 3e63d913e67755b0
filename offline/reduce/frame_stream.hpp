#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "formats/trajectory/trajectory_file.hpp"

namespace greenloop::offline {

/// Frames first .. first + count - 1 of a file.
struct FrameRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// The frames as few ranges, in order, each frame once.
[[nodiscard]] std::vector<FrameRange> joined_ranges(std::vector<FrameRange> ranges);

/// Frames of all ranges.
[[nodiscard]] std::uint64_t frame_count(const std::vector<FrameRange>& ranges);

/// Calls use(frame, displacements) for all frames of the ranges in order, in blocks of at most `block`: displacements
/// from the file's rest shape, m, [3 vertices][frames of the block], which `use` may change. The next block is read
/// meanwhile. Memory: two blocks. Throws what reading and `use` throw.
void stream_frames(const TrajectoryFile& file, const std::vector<FrameRange>& ranges, std::uint64_t block,
                   const std::function<void(std::uint64_t frame, Eigen::Ref<Eigen::MatrixXf> displacements)>& use);

}  // namespace greenloop::offline
