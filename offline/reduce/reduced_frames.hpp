#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "formats/trajectory/trajectory_file.hpp"
#include "offline/reduce/frame_stream.hpp"

namespace greenloop::offline {

/// What a reduction is asked for.
struct ReductionGoal {
  double truncation = 0.01;         ///< eps: modes with a singular value below eps sigma_1 are left out, 0..1
  double tolerance = 0.1;           ///< of singular values and coordinates while frames are read, as part of eps
  std::size_t memory = 512U << 20;  ///< bytes that frames, basis and coordinates may take
};

/// Displacement fields of frames in a basis of few modes (James & Fatahalian 2003, section 2.3): the displacement of a
/// frame from `shape` is modes * coordinates, and what is left out has the squared norm `left_out`.
struct ReducedFrames {
  std::vector<FrameRange> ranges;       ///< the frames, in this order
  std::vector<float> shape;             ///< m, [vertices][3]: rest and the mean displacement
  Eigen::MatrixXf modes;                ///< U_u, [3 vertices][modes], orthonormal
  Eigen::MatrixXd coordinates;          ///< q_u, m, [modes][frames]
  Eigen::VectorXd rest;                 ///< m, [modes]: of the scene at rest
  std::vector<double> left_out;         ///< m^2, of each frame; its root is right within what was unread of the frame
  double rest_left_out = 0;             ///< m^2, of the scene at rest
  std::vector<double> singular_values;  ///< m, of all displacements from `shape`, falling
  double unread = 0;                    ///< m, norm of what was left out while frames were read
  float box_min[3], box_max[3];         ///< m, of all frames and the rest shape

  /// Where a frame's coordinates stand. Throws std::out_of_range for a frame that was not read.
  [[nodiscard]] Eigen::Index column(std::uint64_t frame) const;
};

/// Reduces the frames in one pass over the file. Singular values are right within eps * tolerance * sigma_1. Throws
/// std::runtime_error if nothing moves, the memory is too small, or more than layout::most_modes modes are needed.
/// Memory: goal.memory. Work: one reading, 4 floating point operations for each number and mode of the pass.
[[nodiscard]] ReducedFrames reduce_frames(const TrajectoryFile& file, const std::vector<FrameRange>& ranges,
                                          const ReductionGoal& goal, const std::function<void(double)>& progress);

/// Other frames in the same modes: coordinates and what they leave out. One reading.
struct ProjectedFrames {
  Eigen::MatrixXd coordinates;   ///< m, [modes][frames]
  std::vector<double> left_out;  ///< m^2
};
[[nodiscard]] ProjectedFrames project_frames(const TrajectoryFile& file, const std::vector<FrameRange>& ranges,
                                             const ReducedFrames& reduced);

}  // namespace greenloop::offline
