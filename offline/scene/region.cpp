#include "offline/scene/region.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace greenloop::offline {
namespace {

using Positions = std::span<const Eigen::Vector3d>;
using Box = Eigen::AlignedBox3d;

Eigen::Vector3d at_fractions(const Box& box, const Eigen::Vector3d& fractions) {
  return box.min() + fractions.cwiseProduct(box.sizes());
}

template <typename Test>
std::vector<bool> flags_where(Positions positions, const Test& test) {
  std::vector<bool> flags(positions.size());
  std::transform(positions.begin(), positions.end(), flags.begin(), test);
  return flags;
}

std::vector<bool> select(const HalfSpace& region, Positions positions, const Box& box) {
  const double level = box.min()[region.axis] + region.fraction * box.sizes()[region.axis];
  return flags_where(positions, [&](const Eigen::Vector3d& p) {
    return region.below ? p[region.axis] <= level : p[region.axis] >= level;
  });
}

std::vector<bool> select(const BoxRegion& region, Positions positions, const Box& box) {
  const Box inside(at_fractions(box, region.low), at_fractions(box, region.high));
  return flags_where(positions, [&](const Eigen::Vector3d& p) { return inside.contains(p); });
}

double radius_of(const SphereRegion& region, const Box& box) {
  return region.radius_in_metres ? region.radius : region.radius * box.sizes().maxCoeff();
}

std::vector<bool> select(const SphereRegion& region, Positions positions, const Box& box) {
  const Eigen::Vector3d center = at_fractions(box, region.center);
  const double radius = radius_of(region, box);
  return flags_where(positions, [&](const Eigen::Vector3d& p) { return (p - center).norm() <= radius; });
}

std::vector<bool> select(const NearestRegion& region, Positions positions, const Box& box) {
  const Eigen::Vector3d point = at_fractions(box, region.point);
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) { return std::pair((positions[i] - point).squaredNorm(), i); };
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return key(i) < key(j); });
  std::vector<bool> flags(positions.size(), false);
  for (std::size_t i = 0; i < std::min(order.size(), static_cast<std::size_t>(region.count)); ++i) {
    flags[order[i]] = true;
  }
  return flags;
}

}  // namespace

std::vector<bool> evaluate(const Region& region, Positions positions, const Box& box) {
  return std::visit([&](const auto& shape) { return select(shape, positions, box); }, region);
}

MaskSphere mask_sphere(const SphereRegion& region, Positions positions, const Box& box) {
  const Eigen::Vector3d center = at_fractions(box, region.center);
  const auto vertex = std::min_element(positions.begin(), positions.end(), [&](const auto& a, const auto& b) {
    return (a - center).squaredNorm() < (b - center).squaredNorm();
  });
  return {*vertex, radius_of(region, box)};
}

std::vector<double> linear_mask(const SphereRegion& region, Positions positions, const Box& box) {
  const MaskSphere sphere = mask_sphere(region, positions, box);
  std::vector<double> mask(positions.size());
  std::transform(positions.begin(), positions.end(), mask.begin(), [&](const Eigen::Vector3d& p) {
    return std::max(0.0, 1 - (p - sphere.center).norm() / sphere.radius);
  });
  return mask;
}

std::vector<bool> evaluate(std::span<const Region> regions, Positions positions, const Box& box) {
  std::vector<bool> any(positions.size(), false);
  for (const auto& region : regions) {
    const auto flags = evaluate(region, positions, box);
    std::transform(any.begin(), any.end(), flags.begin(), any.begin(), [](bool a, bool b) { return a || b; });
  }
  return any;
}

}  // namespace greenloop::offline
