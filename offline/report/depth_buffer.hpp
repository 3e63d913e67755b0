#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace greenloop::offline {

/// Which triangle is seen at each sample of a picture: a z-buffer that remembers triangles instead of colours.
/// Vertices are given in samples: x to the right, y down, z towards the viewer; sample (i, j) lies at (i + ½, j + ½).
class DepthBuffer {
 public:
  static constexpr int nothing = -1;

  /// So often a picture may be covered; triangles that come after are left out.
  static constexpr int most_layers = 64;

  DepthBuffer(int width, int height);

  /// Draws triangles over what is there; both sides are seen. Of two surfaces at one sample the nearer stays.
  /// Work: the triangles' area in samples, at most most_layers times the picture's and some
  /// for each triangle.
  void draw(const std::vector<Eigen::Vector3f>& vertices, const std::vector<std::array<int, 3>>& triangles);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Index of the triangle seen there, or `nothing`, also outside the picture.
  [[nodiscard]] int triangle(int x, int y) const;
  /// Its depth there; lowest float where nothing is seen.
  [[nodiscard]] float depth(int x, int y) const;

 private:
  void draw_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, int index);

  int width_;
  int height_;
  std::vector<float> depth_;
  std::vector<int> triangle_;
  std::int64_t room_;  // samples that may still be looked at
};

/// Barycentric weights of (x, y) in the projected triangle; not finite for a triangle seen edge-on.
[[nodiscard]] Eigen::Vector3f barycentric(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                                          float x, float y);

}  // namespace greenloop::offline
