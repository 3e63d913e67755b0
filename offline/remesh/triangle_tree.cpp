#include "offline/remesh/triangle_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace greenloop::offline {
namespace {

constexpr int kLeafTriangles = 4;

/// Barycentric weights of the closest point (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
Eigen::Vector3d closest_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double whole = va + vb + vc;
  return {va / whole, vb / whole, vc / whole};
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Eigen::AlignedBox3d> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    for (const int v : mesh.triangles[t]) boxes[t].extend(mesh.vertices[v]);
  }
  nodes_.reserve(boxes.size());
  build(0, static_cast<int>(order_.size()), boxes);
}

int TriangleTree::build(int first, int count, std::vector<Eigen::AlignedBox3d>& boxes) {
  const int node = static_cast<int>(nodes_.size());
  nodes_.push_back({{}, first, count, -1, -1});
  Eigen::AlignedBox3d box, centers;
  for (int k = first; k < first + count; ++k) {
    box.extend(boxes[order_[k]]);
    centers.extend(boxes[order_[k]].center());
  }
  nodes_[node].box = box;
  if (count <= kLeafTriangles) return node;
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](int s, int t) {
    return std::pair(boxes[s].center()[axis], s) < std::pair(boxes[t].center()[axis], t);
  });
  const int left = build(first, count / 2, boxes);
  const int right = build(first + count / 2, count - count / 2, boxes);
  nodes_[node].count = 0;
  nodes_[node].left = left;
  nodes_[node].right = right;
  return node;
}

void TriangleTree::search(int node, const Eigen::Vector3d& point, double enough, Nearest& nearest) const {
  const auto& [box, first, count, left, right] = nodes_[node];
  for (int k = first; k < first + count; ++k) {
    const auto& [a, b, c] = mesh_.triangles[order_[k]];
    const Eigen::Vector3d weights = closest_weights(point, mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
    const Eigen::Vector3d place =
        weights[0] * mesh_.vertices[a] + weights[1] * mesh_.vertices[b] + weights[2] * mesh_.vertices[c];
    const double squared_distance = (place - point).squaredNorm();
    if (squared_distance < nearest.squared_distance) nearest = {squared_distance, {order_[k], weights}};
  }
  if (left < 0) return;
  const double to_left = nodes_[left].box.squaredExteriorDistance(point);
  const double to_right = nodes_[right].box.squaredExteriorDistance(point);
  const bool left_first = to_left <= to_right;
  for (const bool go_left : {left_first, !left_first}) {
    if (nearest.squared_distance <= enough * enough) return;
    if ((go_left ? to_left : to_right) < nearest.squared_distance)
      search(go_left ? left : right, point, enough, nearest);
  }
}

SurfacePoint TriangleTree::closest(const Eigen::Vector3d& point) const {
  Nearest nearest{std::numeric_limits<double>::infinity(), {}};
  search(0, point, 0, nearest);
  return nearest.place;
}

double TriangleTree::distance(const Eigen::Vector3d& point, double enough) const {
  Nearest nearest{std::numeric_limits<double>::infinity(), {}};
  search(0, point, enough, nearest);
  return std::sqrt(nearest.squared_distance);
}

}  // namespace greenloop::offline
