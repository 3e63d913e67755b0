#include "sim_hw/device/motion_script.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace greenloop {
namespace {

Double3 along(const std::vector<Double3>& knots, double fraction) {
  const double place = fraction * static_cast<double>(knots.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(place), knots.size() - 1);
  const std::size_t second = std::min(first + 1, knots.size() - 1);
  const double share = place - static_cast<double>(first);
  return (1 - share) * knots[first] + share * knots[second];
}

// by the tangent of a quarter of the angle times the axis: rational, so that it has the same bits everywhere
void put_quaternion(const Double3& turned, double (&quaternion)[4]) {
  const double squared = dot(turned, turned);
  const double scale = 1 / (1 + squared);
  quaternion[0] = (1 - squared) * scale;
  quaternion[1] = 2 * scale * turned.x;
  quaternion[2] = 2 * scale * turned.y;
  quaternion[3] = 2 * scale * turned.z;
}

}  // namespace

MotionScript::MotionScript(std::vector<MotionSegment> segments, double seconds) : segments_(std::move(segments)) {
  double sum = 0;
  for (const MotionSegment& segment : segments_) end_.push_back(sum += segment.duration);
  for (double& end : end_) end *= seconds / sum;
}

ProbeTarget MotionScript::target(double time) const {
  const double round = end_.back();
  const double now = time - round * std::floor(time / round);
  const auto found = std::upper_bound(end_.begin(), end_.end(), now);
  const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(found - end_.begin()), end_.size() - 1);
  const double begin = i == 0 ? 0 : end_[i - 1];
  const double share = std::clamp((now - begin) / (end_[i] - begin), 0.0, 1.0);
  const double s = smoothstep(share);
  ProbeTarget target{along(segments_[i].knots, s)};
  put_quaternion((1 - s) * segments_[i].turned_from + s * segments_[i].turned_to, target.quaternion);
  return target;
}

}  // namespace greenloop
