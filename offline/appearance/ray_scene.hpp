#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace greenloop::offline {

/// A surface that light falls on. Triangles counter-clockwise from the side that is lit.
struct LitSurface {
  std::vector<Eigen::Vector3f> positions;  ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Eigen::Array3f> reflectance;  ///< of each vertex, red, green, blue, 0..1
};

/// Where a ray meets a surface.
struct RayHit {
  std::uint32_t triangle = 0;
  float u = 0, v = 0;    ///< barycentric weights of its second and third corner
  bool in_front = true;  ///< on the side that is lit
};

/// A surface for many rays, by Embree.
class RayScene {
 public:
  /// Throws std::runtime_error with Embree's words if it cannot. Work: n log n in the triangles.
  explicit RayScene(const LitSurface& surface);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// The first triangle that a ray meets farther away than `near`, m; none: it leaves.
  [[nodiscard]] std::optional<RayHit> first_hit(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                                                float near) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace greenloop::offline
