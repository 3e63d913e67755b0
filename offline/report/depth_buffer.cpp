#include "offline/report/depth_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace greenloop::offline {

namespace {

/// Samples of a triangle that are not counted: of a fine mesh there are many to a sample.
constexpr std::int64_t small_triangle = 16;

/// A whole number within 0 .. limit, whatever the place is.
int pixel(float place, int limit) {
  return place > 0 ? place < static_cast<float>(limit) ? static_cast<int>(place) : limit : 0;
}

}  // namespace

DepthBuffer::DepthBuffer(int width, int height)
    : width_(width),
      height_(height),
      depth_(static_cast<std::size_t>(width) * height, std::numeric_limits<float>::lowest()),
      triangle_(depth_.size(), nothing),
      room_(std::int64_t{most_layers} * width * height) {}

void DepthBuffer::draw(const std::vector<Eigen::Vector3f>& vertices, const std::vector<std::array<int, 3>>& triangles) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    draw_triangle(vertices[a], vertices[b], vertices[c], static_cast<int>(t));
  }
}

void DepthBuffer::draw_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                                int index) {
  const Eigen::Vector3f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  const int x0 = pixel(std::floor(low.x()), width_), x1 = pixel(std::ceil(high.x()), width_);
  const int y0 = pixel(std::floor(low.y()), height_), y1 = pixel(std::ceil(high.y()), height_);
  const std::int64_t pixels = std::int64_t{std::max(x1 - x0, 0)} * std::max(y1 - y0, 0);
  if (pixels > small_triangle) {
    if (pixels > room_) return;
    room_ -= pixels;
  }
  // the weights are linear over the picture
  const float first_x = static_cast<float>(x0) + 0.5F, first_y = static_cast<float>(y0) + 0.5F;
  const Eigen::Vector3f first = barycentric(a, b, c, first_x, first_y);
  const Eigen::Vector3f per_x = barycentric(a, b, c, first_x + 1, first_y) - first;
  const Eigen::Vector3f per_y = barycentric(a, b, c, first_x, first_y + 1) - first;
  constexpr float rounding = 1e-5F;  // a sample on an edge belongs to both neighbours rather than to none
  for (int y = y0; y < y1; ++y) {
    const Eigen::Vector3f row = first + static_cast<float>(y - y0) * per_y;
    for (int x = x0; x < x1; ++x) {
      const Eigen::Vector3f weight = row + static_cast<float>(x - x0) * per_x;
      if (!(weight.minCoeff() >= -rounding)) continue;
      const float depth = weight.x() * a.z() + weight.y() * b.z() + weight.z() * c.z();
      const std::size_t at = static_cast<std::size_t>(y) * width_ + x;
      if (depth <= depth_[at]) continue;
      depth_[at] = depth;
      triangle_[at] = index;
    }
  }
}

int DepthBuffer::triangle(int x, int y) const {
  const bool inside = x >= 0 && x < width_ && y >= 0 && y < height_;
  return inside ? triangle_[static_cast<std::size_t>(y) * width_ + x] : nothing;
}

float DepthBuffer::depth(int x, int y) const {
  const bool inside = x >= 0 && x < width_ && y >= 0 && y < height_;
  return inside ? depth_[static_cast<std::size_t>(y) * width_ + x] : std::numeric_limits<float>::lowest();
}

Eigen::Vector3f barycentric(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, float x,
                            float y) {
  const float doubled_area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
  const float of_b = ((x - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (y - a.y())) / doubled_area;
  const float of_c = ((b.x() - a.x()) * (y - a.y()) - (x - a.x()) * (b.y() - a.y())) / doubled_area;
  return {1 - of_b - of_c, of_b, of_c};
}

}  // namespace greenloop::offline
