#include "runtime/mask.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop {
namespace {

// of a corner's function at a node, times its area
double spread(Vec3 corner, const layout::NodeRecord& node, float area, float radius) {
  const double x = double{node.position[0]} - corner.x;
  const double y = double{node.position[1]} - corner.y;
  const double z = double{node.position[2]} - corner.z;
  const double part = 1 - std::sqrt(x * x + y * y + z * z) / radius;
  return part > 0 ? part * area : 0;
}

// calls visit(node, record) for the touchable nodes of the first `nodes`
template <class Visit>
void visit_touchable(const ModelView& view, std::size_t nodes, Visit visit) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count && level.node_begin + i < nodes; ++i) {
      if ((level.nodes[i].flags & layout::node_touchable) != 0) {
        visit(level.node_begin + i, level.nodes[i]);
      }
    }
  }
}

struct Corner {
  Vec3 position;
  double share = 0;  // of the point, over the sum of its function times areas
};

// false if it has no part, or is no node of these
bool fill_corner(const Model& model, std::span<const float> area, const MeshPoint& point, std::size_t k, float radius,
                 Corner& corner) {
  const std::uint32_t node = point.node[k];
  if (node >= area.size() || !std::isfinite(point.weight[k])) {
    return false;
  }
  if (point.weight[k] == 0 || !model.is_touchable(node)) {
    return true;
  }
  corner.position = model.position(node);
  double sum = 0;
  visit_touchable(model.view(), area.size(), [&](std::uint32_t at, const layout::NodeRecord& record) {
    sum += spread(corner.position, record, area[at], radius);
  });
  corner.share = point.weight[k] / sum;
  return std::isfinite(corner.share);
}

// of the positions, by the weights
Vec3 centre_of(const Model& model, const Mask& mask) {
  double sum[4] = {};
  for (std::size_t k = 0; k < mask.node.size(); ++k) {
    const Vec3 x = model.position(mask.node[k]);
    const double weight = mask.weight[k];
    sum[0] += weight * x.x;
    sum[1] += weight * x.y;
    sum[2] += weight * x.z;
    sum[3] += weight;
  }
  return {static_cast<float>(sum[0] / sum[3]), static_cast<float>(sum[1] / sum[3]),
          static_cast<float>(sum[2] / sum[3])};
}

}  // namespace

DirectedMask direct_mask(const Mask& mask, Vec3 direction, std::span<Vec3> part) noexcept {
  const std::size_t count = mask.node.size();
  if (count > part.size() || count != mask.weight.size()) {
    return {};
  }
  for (std::size_t k = 0; k < count; ++k) {
    const float weight = mask.weight[k];
    part[k] = {weight * direction.x, weight * direction.y, weight * direction.z};
  }
  return {mask.node, part.first(count)};
}

DirectedMask make_torque_mask(const Model& model, const Mask& mask, Vec3 axis, std::span<Vec3> part) noexcept {
  const std::size_t count = mask.node.size();
  const auto known = [&](std::uint32_t node) { return node < model.node_count(); };
  if (count > part.size() || count != mask.weight.size() || !std::all_of(mask.node.begin(), mask.node.end(), known)) {
    return {};
  }
  const Vec3 centre = centre_of(model, mask);
  double square = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 x = model.position(mask.node[k]);
    const Vec3 r{x.x - centre.x, x.y - centre.y, x.z - centre.z};
    part[k] = {axis.y * r.z - axis.z * r.y, axis.z * r.x - axis.x * r.z, axis.x * r.y - axis.y * r.x};
    const Vec3& t = part[k];
    square += double{mask.weight[k]} * (double{t.x} * t.x + double{t.y} * t.y + double{t.z} * t.z);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto scale = static_cast<float>(mask.weight[k] / square);
    part[k] = {scale * part[k].x, scale * part[k].y, scale * part[k].z};
  }
  return square > 0 && std::isfinite(1 / square) ? DirectedMask{mask.node, part.first(count)} : DirectedMask{};
}

Mask make_mask(const Model& model, std::span<const float> area, const MeshPoint& point, float radius,
               std::span<std::uint32_t> node, std::span<float> weight) noexcept {
  if (area.size() > model.node_count() || !(radius > 0) || !std::isfinite(radius)) {
    return {};
  }
  Corner corners[3];
  for (std::size_t k = 0; k < 3; ++k) {
    if (!fill_corner(model, area, point, k, radius, corners[k])) {
      return {};
    }
  }
  std::size_t count = 0;
  visit_touchable(model.view(), area.size(), [&](std::uint32_t at, const layout::NodeRecord& record) {
    double part = 0;
    for (const Corner& corner : corners) {
      part += corner.share == 0 ? 0 : corner.share * spread(corner.position, record, area[at], radius);
    }
    if (part > 0) {
      if (count < std::min(node.size(), weight.size())) {
        node[count] = at;
        weight[count] = static_cast<float>(part);
      }
      ++count;
    }
  });
  return count <= std::min(node.size(), weight.size()) ? Mask{node.first(count), weight.first(count)} : Mask{};
}

}  // namespace greenloop
