#include "offline/report/mesh_picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "offline/report/colour_map.hpp"
#include "offline/report/depth_buffer.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int supersampling = 3;
constexpr int margin = 8;  // pixels

const Colour fixed_colour(0.07F, 0.38F, 0.68F);
const Colour rest_outline_colour(0.52F, 0.55F, 0.58F);
const Colour edge_colour(0.20F, 0.25F, 0.30F);
const Colour plain_colour(0.90F, 0.90F, 0.89F);
const Colour touchable_colour(0.70F, 0.85F, 0.95F);

/// A surface projected to the samples of a picture, with what shading needs.
struct Projection {
  std::vector<Vector3f> samples;
  std::vector<Vector3f> normals;  ///< per vertex, in the camera's frame
  DepthBuffer buffer;
};

Vector3f to_camera(const ViewFrame& frame, const Vector3d& direction) {
  return Vector3d(direction.dot(frame.right), direction.dot(frame.up), direction.dot(frame.towards)).cast<float>();
}

std::vector<Vector3f> triangle_normals(const std::vector<Vector3d>& positions,
                                       const std::vector<std::array<int, 3>>& triangles, const ViewFrame& frame) {
  std::vector<Vector3f> normals;
  normals.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const Vector3d doubled_area = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    normals.push_back(to_camera(frame, doubled_area.normalized()));
  }
  return normals;
}

std::vector<Vector3f> vertex_normals(const std::vector<Vector3d>& positions,
                                     const std::vector<std::array<int, 3>>& triangles, const ViewFrame& frame) {
  std::vector<Vector3d> sum(positions.size(), Vector3d::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vector3d doubled_area = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const int v : {a, b, c}) sum[v] += doubled_area;
  }
  std::vector<Vector3f> normals;
  normals.reserve(sum.size());
  for (const Vector3d& normal : sum) normals.push_back(to_camera(frame, normal.normalized()));
  return normals;
}

Projection project(const Camera& camera, const std::vector<Vector3d>& positions,
                   const std::vector<std::array<int, 3>>& triangles) {
  Projection projection{{},
                        vertex_normals(positions, triangles, camera.frame),
                        {camera.width * supersampling, camera.height * supersampling}};
  projection.samples.reserve(positions.size());
  for (const Vector3d& position : positions) {
    projection.samples.emplace_back((camera.project(position) * supersampling).cast<float>());
  }
  projection.buffer.draw(projection.samples, triangles);
  return projection;
}

/// One point of a surface under a sample.
struct SurfacePoint {
  std::array<int, 3> vertices;
  Vector3f weight;
  Vector3f normal;

  template <class Value>
  [[nodiscard]] float interpolate(const std::vector<Value>& values) const {
    return weight.x() * static_cast<float>(values[vertices[0]]) + weight.y() * static_cast<float>(values[vertices[1]]) +
           weight.z() * static_cast<float>(values[vertices[2]]);
  }
};

SurfacePoint surface_point(const Projection& projection, const std::vector<std::array<int, 3>>& triangles, int x,
                           int y) {
  const auto& [a, b, c] = triangles[projection.buffer.triangle(x, y)];
  const Vector3f weight = barycentric(projection.samples[a], projection.samples[b], projection.samples[c],
                                      static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
  const Vector3f normal =
      weight.x() * projection.normals[a] + weight.y() * projection.normals[b] + weight.z() * projection.normals[c];
  return {{a, b, c}, weight, normal.normalized()};
}

/// A key light from the upper left, a fill light from the right, and a soft highlight (Blinn-Phong).
Colour lit(const Colour& colour, Vector3f normal) {
  static const Vector3f key = Vector3f(-0.45F, 0.65F, 0.75F).normalized();
  static const Vector3f fill = Vector3f(0.75F, 0.05F, 0.5F).normalized();
  static const Vector3f half = (key + Vector3f::UnitZ()).normalized();
  if (normal.z() < 0) normal = -normal;
  const float diffuse =
      0.55F + 0.05F * normal.y() + 0.38F * std::max(normal.dot(key), 0.0F) + 0.15F * std::max(normal.dot(fill), 0.0F);
  const float highlight = 0.10F * std::pow(std::max(normal.dot(half), 0.0F), 28.0F);
  return (colour * diffuse + Colour::Constant(highlight)).cwiseMin(1.0F);
}

/// How much of the sky above it a sample sees: 1 in the open, less in creases; from the depths around it.
float openness(const DepthBuffer& buffer, int x, int y, float radius) {
  constexpr int directions = 12;
  float hidden = 0;
  for (int ring = 1; ring <= 2; ++ring) {
    for (int k = 0; k < directions; ++k) {
      const float angle = static_cast<float>(2 * k + ring) * std::numbers::pi_v<float> / directions;
      const float reach = radius * static_cast<float>(ring) / 2;
      const int there_x = x + static_cast<int>(reach * std::cos(angle));
      const int there_y = y + static_cast<int>(reach * std::sin(angle));
      const float rise = buffer.depth(there_x, there_y) - buffer.depth(x, y);
      if (rise > 0.4F * reach && rise < 6 * radius) hidden += std::min(rise / reach - 0.4F, 1.0F);
    }
  }
  return 1 - 0.55F * hidden / (2 * directions);
}

/// The openness of each pixel, at its first sample that shows anything.
std::vector<float> openness_of_pixels(const DepthBuffer& buffer) {
  const int width = buffer.width() / supersampling, height = buffer.height() / supersampling;
  const float radius = 0.03F * static_cast<float>(std::max(buffer.width(), buffer.height()));
  std::vector<float> open(static_cast<std::size_t>(width) * height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < supersampling * supersampling; ++k) {
        const int sample_x = x * supersampling + k % supersampling, sample_y = y * supersampling + k / supersampling;
        if (buffer.triangle(sample_x, sample_y) == DepthBuffer::nothing) continue;
        open[static_cast<std::size_t>(y) * width + x] = openness(buffer, sample_x, sample_y, radius);
        break;
      }
    }
  }
  return open;
}

float at_sample(const std::vector<float>& pixels, const DepthBuffer& buffer, int x, int y) {
  return pixels[static_cast<std::size_t>(y / supersampling) * (buffer.width() / supersampling) + x / supersampling];
}

/// Marks the samples of discs around the vertices that are chosen and seen.
std::vector<char> visible_discs(const Projection& projection, const std::vector<char>& chosen, float radius) {
  const DepthBuffer& buffer = projection.buffer;
  std::vector<char> mask(static_cast<std::size_t>(buffer.width()) * buffer.height(), 0);
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    if (!chosen[v]) continue;
    const Vector3f& centre = projection.samples[v];
    const int cx = static_cast<int>(centre.x()), cy = static_cast<int>(centre.y()),
              reach = static_cast<int>(radius) + 1;
    if (centre.z() < buffer.depth(cx, cy) - 2 * radius) continue;
    for (int y = cy - reach; y <= cy + reach; ++y) {
      for (int x = cx - reach; x <= cx + reach; ++x) {
        const bool near = std::abs(buffer.depth(x, y) - centre.z()) < 4 * radius;
        const bool within =
            std::hypot(static_cast<float>(x) - centre.x(), static_cast<float>(y) - centre.y()) <= radius;
        if (near && within) mask[static_cast<std::size_t>(y) * buffer.width() + x] = 1;
      }
    }
  }
  return mask;
}

/// The inner rim, `thickness` samples wide, of what a buffer covers.
bool on_rim(const DepthBuffer& buffer, int x, int y, int thickness) {
  if (buffer.triangle(x, y) == DepthBuffer::nothing) return false;
  const int diagonal = std::max(thickness * 7 / 10, 1);
  for (const auto& [dx, dy] : {std::array{thickness, 0}, {-thickness, 0}, {0, thickness}, {0, -thickness}}) {
    if (buffer.triangle(x + dx, y + dy) == DepthBuffer::nothing) return true;
  }
  for (const auto& [dx, dy] : {std::array{1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
    if (buffer.triangle(x + diagonal * dx, y + diagonal * dy) == DepthBuffer::nothing) return true;
  }
  return false;
}

/// Distance in samples from a surface point to the nearest edge of its triangle.
float edge_distance(const Projection& projection, const SurfacePoint& point) {
  float nearest = 1e9F;
  for (int k = 0; k < 3; ++k) {
    const Vector3f& a = projection.samples[point.vertices[k]];
    const Vector3f& b = projection.samples[point.vertices[(k + 1) % 3]];
    const Vector3f& c = projection.samples[point.vertices[(k + 2) % 3]];
    const float doubled_area = std::abs((b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y()));
    nearest = std::min(nearest, point.weight[k] * doubled_area / std::hypot(c.x() - b.x(), c.y() - b.y()));
  }
  return nearest;
}

/// Colour and coverage of one sample.
struct Sample {
  Colour colour = Colour::Zero();
  float alpha = 0;
};

Image average_samples(int width, int height, const std::function<Sample(int, int)>& sample) {
  Image image(width, height);
  constexpr float count = supersampling * supersampling;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Colour colour = Colour::Zero();
      float alpha = 0;
      for (int k = 0; k < supersampling * supersampling; ++k) {
        const Sample one = sample(x * supersampling + k % supersampling, y * supersampling + k / supersampling);
        colour += one.alpha * one.colour;
        alpha += one.alpha;
      }
      if (alpha == 0) continue;
      const auto byte = [](float v) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0F, 1.0F))); };
      colour /= alpha;
      image.at(x, y) = {byte(colour.x()), byte(colour.y()), byte(colour.z()), byte(alpha / count)};
    }
  }
  return image;
}

double mean_edge(const Projection& projection, const std::vector<std::array<int, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += (projection.samples[b] - projection.samples[a]).norm();
  return triangles.empty() ? 0 : sum / static_cast<double>(triangles.size());
}

}  // namespace

double exaggeration(double largest, double size) {
  if (!(largest > 0)) return 1;
  const double room = 0.1 * size / largest;
  if (room <= 1 && largest <= 0.3 * size) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(room)));
  for (const double multiple : {5.0, 2.0}) {
    if (multiple * power <= room * (1 + 1e-9)) return multiple * power;
  }
  return power;
}

Picture deformed_picture(const VisibleSurface& surface, const std::vector<Vector3d>& magnified,
                         const std::vector<float>& value, const ViewFrame& frame, int longest) {
  std::vector<Vector3d> positions = surface.positions;
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += magnified[i];
  std::vector<Vector3d> both = positions;
  both.insert(both.end(), surface.positions.begin(), surface.positions.end());
  const Camera camera = fit_camera(frame, both, longest, margin);
  const Projection body = project(camera, positions, surface.triangles);
  const Projection rest = project(camera, surface.positions, surface.triangles);
  const auto dots = visible_discs(body, surface.fixed, 2.8F * supersampling);
  const auto open = openness_of_pixels(body.buffer);

  const auto sample = [&](int x, int y) -> Sample {
    if (on_rim(rest.buffer, x, y, supersampling * 3 / 2)) return {rest_outline_colour, 1};
    if (body.buffer.triangle(x, y) == DepthBuffer::nothing) return {};
    const SurfacePoint point = surface_point(body, surface.triangles, x, y);
    const bool dotted = dots[static_cast<std::size_t>(y) * body.buffer.width() + x] != 0;
    if (dotted) return {fixed_colour, 1};
    return {lit(displacement_colour(point.interpolate(value)), point.normal) * at_sample(open, body.buffer, x, y), 1};
  };
  return {average_samples(camera.width, camera.height, sample), camera};
}

Picture coloured_picture(const VisibleSurface& surface, const std::vector<Vector3d>& displacement,
                         const std::vector<Vector3f>& colour, const ViewFrame& frame, int longest) {
  std::vector<Vector3d> positions = surface.positions;
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += displacement[i];
  const Camera camera = fit_camera(frame, positions, longest, margin);
  const Projection body = project(camera, positions, surface.triangles);
  const auto sample = [&](int x, int y) -> Sample {
    if (body.buffer.triangle(x, y) == DepthBuffer::nothing) return {};
    const SurfacePoint point = surface_point(body, surface.triangles, x, y);
    Colour seen = Colour::Zero();
    for (int k = 0; k < 3; ++k) seen += point.weight[k] * colour[static_cast<std::size_t>(point.vertices[k])];
    return {seen, 1};
  };
  return {average_samples(camera.width, camera.height, sample), camera};
}

Picture wire_picture(const VisibleSurface& surface, const std::vector<char>& touchable,
                     const std::vector<Vector3d>& framed_points, const ViewFrame& frame, int longest) {
  const Camera camera = fit_camera(frame, framed_points, longest, margin);
  const Projection body = project(camera, surface.positions, surface.triangles);
  const auto face_normals = triangle_normals(surface.positions, surface.triangles, frame);
  const double edge_pixels = mean_edge(body, surface.triangles) / supersampling;
  const float edge_opacity = static_cast<float>(std::clamp(edge_pixels / 14, 0.25, 0.9));
  const float half_width = (edge_pixels > 30 ? 1.1F : edge_pixels > 12 ? 0.75F : 0.5F) * supersampling;
  const auto dots =
      visible_discs(body, surface.fixed, static_cast<float>(std::clamp(edge_pixels / 5, 1.6, 4.0)) * supersampling);
  const auto open = openness_of_pixels(body.buffer);

  const auto sample = [&](int x, int y) -> Sample {
    if (body.buffer.triangle(x, y) == DepthBuffer::nothing) return {};
    const SurfacePoint point = surface_point(body, surface.triangles, x, y);
    const float touch = point.interpolate(touchable);
    const Vector3f& flat_normal = face_normals[body.buffer.triangle(x, y)];
    Colour colour =
        lit((1 - touch) * plain_colour + touch * touchable_colour, flat_normal) * at_sample(open, body.buffer, x, y);
    if (edge_distance(body, point) < half_width) colour = (1 - edge_opacity) * colour + edge_opacity * edge_colour;
    if (dots[static_cast<std::size_t>(y) * body.buffer.width() + x] != 0) colour = fixed_colour;
    return {colour, 1};
  };
  return {average_samples(camera.width, camera.height, sample), camera};
}

}  // namespace greenloop::offline
