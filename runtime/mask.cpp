#include "runtime/mask.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/surface.hpp"
#include "runtime/surface/parts.hpp"

namespace greenloop {
namespace {

struct Point {
  double x = 0, y = 0, z = 0;
};

Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

double length(Point a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

Point cross(Point a, Point b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

Point position(const layout::NodeRecord& node) {
  return {double{node.position[0]}, double{node.position[1]}, double{node.position[2]}};
}

bool is_touchable(const layout::NodeRecord& node) { return (node.flags & layout::node_touchable) != 0; }

// of a triangle's corners
struct Integrals {
  double of[3] = {};
};

// parts along an edge, so that there are some within the radius
int parts_of(double edge, double radius) {
  constexpr int most = 8;
  const double parts = 2 * edge / radius;
  return parts <= 2 ? 2 : parts >= most ? most : static_cast<int>(parts) + 1;
}

// of a corner's function with the linear functions of a triangle, by the middles of its parts
Integrals integrals(const Point& corner, const Point (&x)[3], double radius) {
  Integrals sum;
  const Point ab = x[1] - x[0], ac = x[2] - x[0];
  const double edge = std::max({length(ab), length(ac), length(x[2] - x[1])});
  if (length(x[0] - corner) >= radius + edge) return sum;
  const int parts = parts_of(edge, radius);
  const double area = 0.5 * length(cross(ab, ac)) / (parts * parts);
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; j < 2 * (parts - i) - 1; ++j) {
      // parts stand in rows, every other one upside down
      const double third = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
      const int pair = j / 2;
      const double v = (i + third) / parts, w = (pair + third) / parts, u = 1 - v - w;
      const Point middle{u * x[0].x + v * x[1].x + w * x[2].x, u * x[0].y + v * x[1].y + w * x[2].y,
                         u * x[0].z + v * x[1].z + w * x[2].z};
      const double part = std::max(0.0, 1 - length(middle - corner) / radius) * area;
      sum.of[0] += u * part;
      sum.of[1] += v * part;
      sum.of[2] += w * part;
    }
  }
  return sum;
}

// calls visit(node, integral) for the touchable corners of the triangles near a corner, a node as often as it stands in
// them
template <class Visit>
void visit_near(const Surface& surface, std::uint32_t level, const Point& corner, double radius, Visit visit) {
  const layout::NodeRecord* const nodes = surface.parts().nodes;
  for (std::uint32_t t = 0; t < surface.triangle_count(level); ++t) {
    const Surface::Triangle triangle = surface.triangle(level, t);
    const Point x[3] = {position(nodes[triangle.node[0]]), position(nodes[triangle.node[1]]),
                        position(nodes[triangle.node[2]])};
    const Integrals of = integrals(corner, x, radius);
    for (std::size_t k = 0; k < 3; ++k) {
      if (of.of[k] > 0 && is_touchable(nodes[triangle.node[k]])) visit(triangle.node[k], of.of[k]);
    }
  }
}

// a mask that is being made, in the caller's memory
class Parts {
 public:
  Parts(std::span<std::uint32_t> node, std::span<float> weight)
      : node_(node), weight_(weight), room_(std::min(node.size(), weight.size())) {}

  void add(std::uint32_t node, double part) {
    std::size_t at = 0;
    while (at < count_ && node_[at] != node) ++at;
    if (at == room_) {
      fits_ = false;
      return;
    }
    if (at == count_) {
      node_[count_] = node;
      weight_[count_++] = 0;
    }
    weight_[at] += static_cast<float>(part);
  }
  [[nodiscard]] Mask take() const { return fits_ ? Mask{node_.first(count_), weight_.first(count_)} : Mask{}; }

 private:
  std::span<std::uint32_t> node_;
  std::span<float> weight_;
  std::size_t room_, count_ = 0;
  bool fits_ = true;
};

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

Mask make_mask(const Surface& surface, std::uint32_t level, const MeshPoint& point, float radius,
               std::span<std::uint32_t> node, std::span<float> weight) noexcept {
  if (surface.node_count(level) == 0 || !(radius > 0) || !std::isfinite(radius)) return {};
  Parts parts(node, weight);
  for (std::size_t k = 0; k < 3; ++k) {
    if (point.node[k] >= surface.node_count(level) || !std::isfinite(point.weight[k])) return {};
    const layout::NodeRecord& corner = surface.parts().nodes[point.node[k]];
    if (point.weight[k] == 0 || !is_touchable(corner)) continue;
    const Point centre = position(corner);
    double sum = 0;
    visit_near(surface, level, centre, radius, [&sum](std::uint32_t, double part) { sum += part; });
    const double share = static_cast<double>(point.weight[k]) / sum;
    if (!(sum > 0)) {
      parts.add(point.node[k], static_cast<double>(point.weight[k]));
    } else if (std::isfinite(share)) {
      visit_near(surface, level, centre, radius, [&](std::uint32_t at, double part) { parts.add(at, share * part); });
    } else {
      return {};
    }
  }
  return parts.take();
}

}  // namespace greenloop
