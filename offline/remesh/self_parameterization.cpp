#include "offline/remesh/self_parameterization.hpp"

#include <algorithm>

namespace greenloop::offline {
namespace {

/// Points by the triangle they lie on, so that a collapse touches only those of its patch.
class PointBuckets {
 public:
  PointBuckets(std::vector<SurfacePoint>& points, std::size_t triangles) : points_(points), held_(triangles) {
    for (std::size_t k = 0; k < points.size(); ++k) held_[points[k].triangle].push_back(static_cast<int>(k));
  }

  void carry(const std::vector<FlatTriangle>& from, const std::vector<FlatTriangle>& to) {
    std::vector<int> moving;
    std::vector<Eigen::Vector2d> places;
    for (const auto& flat : from) {
      for (const int k : held_[flat.triangle]) {
        const auto& w = points_[k].weights;
        moving.push_back(k);
        places.emplace_back(w[0] * flat.corners[0] + w[1] * flat.corners[1] + w[2] * flat.corners[2]);
      }
      held_[flat.triangle].clear();
    }
    for (std::size_t m = 0; m < moving.size(); ++m) {
      const auto [index, weights] = locate(to, places[m]);
      points_[moving[m]] = {to[index].triangle, weights};
      held_[to[index].triangle].push_back(moving[m]);
    }
  }

 private:
  std::vector<SurfacePoint>& points_;
  std::vector<std::vector<int>> held_;
};

}  // namespace

std::vector<SurfacePoint> SelfParameterization::to_input(std::vector<SurfacePoint> points) const {
  int triangles = 0;
  for (const int id : base_ids) triangles = std::max(triangles, id + 1);
  for (const auto& patch : changes) {
    for (const auto& flat : patch.before) triangles = std::max(triangles, flat.triangle + 1);
  }
  for (auto& point : points) point.triangle = base_ids[point.triangle];
  PointBuckets buckets(points, triangles);
  for (auto patch = changes.rbegin(); patch != changes.rend(); ++patch) buckets.carry(patch->after, patch->before);
  return points;
}

}  // namespace greenloop::offline
