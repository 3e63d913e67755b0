#include "offline/reduce/reduced_frames.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "formats/layout.hpp"
#include "offline/reduce/streaming_basis.hpp"
#include "offline/single_threaded_blas.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;

constexpr std::uint64_t frames_of_block = 64;

/// How many modes fit into the memory beside three blocks of frames and the final modes.
Index most_modes(std::size_t size, std::uint64_t frames, std::size_t memory) {
  const double column = 4.0 * static_cast<double>(size);
  const double rest = static_cast<double>(memory) - column * (3.0 * frames_of_block + layout::most_modes);
  const double modes = rest / (column + 16.0 * static_cast<double>(frames));
  if (modes < 2.0 * frames_of_block) {
    throw std::runtime_error("reduction: " + std::to_string(memory >> 20) + " MB are too few for " +
                             std::to_string(size / 3) + " vertices and " + std::to_string(frames) + " frames");
  }
  return static_cast<Index>(
      std::min(modes, static_cast<double>(std::min<std::uint64_t>(size, frames)) + frames_of_block));
}

void widen_box(const Eigen::Ref<const MatrixXf>& displacements, const std::vector<float>& rest,
               ReducedFrames& reduced) {
  for (Index c = 0; c < displacements.cols(); ++c) {
    const float* const moved = displacements.col(c).data();
    for (std::size_t v = 0; v < rest.size(); v += 3) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float x = rest[v + axis] + moved[v + axis];
        reduced.box_min[axis] = std::min(reduced.box_min[axis], x);
        reduced.box_max[axis] = std::max(reduced.box_max[axis], x);
      }
    }
  }
}

/// How many modes the goal asks for, and one more where that is odd.
Index wanted_modes(const std::vector<double>& sigma, double truncation) {
  if (!(sigma.front() > 0)) throw std::runtime_error("reduction: nothing moves in these trajectories");
  const auto end = std::find_if(sigma.begin(), sigma.end(), [&](double s) { return s < truncation * sigma.front(); });
  const auto count = static_cast<std::size_t>(end - sigma.begin());
  if (count > layout::most_modes) {
    throw std::runtime_error("reduction: " + std::to_string(count) + " modes are needed, at most " +
                             std::to_string(layout::most_modes) + " fit a model; raise accuracy.truncation");
  }
  return static_cast<Index>(count + count % 2);
}

/// Turns coordinates to principal axes about their mean and keeps the leading ones.
void take_principal(const StreamingBasis& streamed, const std::vector<float>& rest, double truncation,
                    ReducedFrames& reduced) {
  MatrixXd all = MatrixXd::Zero(streamed.modes() + streamed.modes() % 2, static_cast<Index>(streamed.dropped().size()));
  all.topRows(streamed.modes()) = streamed.coordinates();
  const Eigen::VectorXd mean = all.rowwise().mean();
  all.colwise() -= mean;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(all * all.transpose());
  for (Index j = 0; j < all.rows(); ++j) {
    reduced.singular_values.push_back(std::sqrt(std::max(eigen.eigenvalues()[all.rows() - 1 - j], 0.0)));
  }
  const Index count = wanted_modes(reduced.singular_values, truncation);
  const MatrixXd turn = eigen.eigenvectors().rowwise().reverse();
  const MatrixXd turned = turn.transpose() * all;
  const Eigen::VectorXd rest_turned = turn.transpose() * -mean;
  reduced.coordinates = turned.topRows(count);
  reduced.rest = rest_turned.head(count);
  reduced.rest_left_out = rest_turned.tail(all.rows() - count).squaredNorm();
  reduced.left_out = streamed.dropped();
  for (Index c = 0; c < turned.cols(); ++c) {
    reduced.left_out[static_cast<std::size_t>(c)] += turned.col(c).tail(all.rows() - count).squaredNorm();
  }
  double unread = 0;
  for (const double square : streamed.dropped()) unread += square;
  reduced.unread = std::sqrt(unread);
  reduced.modes = streamed.basis() * turn.topLeftCorner(streamed.modes(), count).cast<float>();
  const Eigen::VectorXf shift = streamed.basis() * mean.head(streamed.modes()).cast<float>();
  reduced.shape = rest;
  for (std::size_t k = 0; k < rest.size(); ++k) reduced.shape[k] += shift[static_cast<Index>(k)];
}

}  // namespace

Index ReducedFrames::column(std::uint64_t frame) const {
  std::uint64_t before = 0;
  for (const FrameRange& range : ranges) {
    if (frame >= range.first && frame - range.first < range.count) {
      return static_cast<Index>(before + (frame - range.first));
    }
    before += range.count;
  }
  throw std::out_of_range("reduction: frame " + std::to_string(frame) + " was not read");
}

ReducedFrames reduce_frames(const TrajectoryFile& file, const std::vector<FrameRange>& ranges,
                            const ReductionGoal& goal, const std::function<void(double)>& progress) {
  const std::vector<float>& rest = file.scene().rest;
  const std::uint64_t frames = frame_count(ranges);
  if (frames == 0) throw std::runtime_error(file.path().string() + ": no orbit is there to build from");
  ReducedFrames reduced;
  reduced.ranges = ranges;
  std::fill_n(reduced.box_min, 3, std::numeric_limits<float>::max());
  std::fill_n(reduced.box_max, 3, std::numeric_limits<float>::lowest());
  widen_box(MatrixXf::Zero(static_cast<Index>(rest.size()), 1), rest, reduced);

  StreamingBasis basis(static_cast<Index>(rest.size()), static_cast<Index>(frames), goal.truncation * goal.tolerance,
                       most_modes(rest.size(), frames, goal.memory));
  std::uint64_t done = 0;
  const SingleThreadedBlas one_thread;  // and no other in the way of the one that reads
  stream_frames(file, ranges, frames_of_block, [&](std::uint64_t, Eigen::Ref<MatrixXf> displacements) {
    widen_box(displacements, rest, reduced);
    basis.add(displacements);
    progress(static_cast<double>(done += static_cast<std::uint64_t>(displacements.cols())) /
             static_cast<double>(frames));
  });
  if (basis.modes() == 0) throw std::runtime_error("reduction: nothing moves in these trajectories");
  take_principal(basis, rest, goal.truncation, reduced);
  return reduced;
}

ProjectedFrames project_frames(const TrajectoryFile& file, const std::vector<FrameRange>& ranges,
                               const ReducedFrames& reduced) {
  const std::uint64_t frames = frame_count(ranges);
  const auto size = static_cast<Index>(file.scene().rest.size());
  const Eigen::VectorXf shift = Eigen::Map<const Eigen::VectorXf>(reduced.shape.data(), size) -
                                Eigen::Map<const Eigen::VectorXf>(file.scene().rest.data(), size);
  ProjectedFrames projected{MatrixXd(reduced.modes.cols(), static_cast<Index>(frames)), {}};
  Index column = 0;
  stream_frames(file, ranges, frames_of_block, [&](std::uint64_t, Eigen::Ref<MatrixXf> displacements) {
    displacements.colwise() -= shift;
    const MatrixXf part = reduced.modes.transpose() * displacements;
    displacements -= reduced.modes * part;
    projected.coordinates.middleCols(column, part.cols()) = part.cast<double>();
    for (Index c = 0; c < part.cols(); ++c) {
      projected.left_out.push_back(displacements.col(c).cast<double>().squaredNorm());
    }
    column += part.cols();
  });
  return projected;
}

}  // namespace greenloop::offline
