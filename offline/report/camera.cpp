#include "offline/report/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "offline/report/depth_buffer.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr double radians = std::numbers::pi / 180;

std::vector<Vector3d> moved(const VisibleSurface& surface, const std::vector<Vector3d>& displacement) {
  std::vector<Vector3d> positions = surface.positions;
  for (std::size_t i = 0; i < displacement.size(); ++i) positions[i] += displacement[i];
  return positions;
}

std::vector<Eigen::Vector3f> projected(const Camera& camera, const std::vector<Vector3d>& positions) {
  std::vector<Eigen::Vector3f> pixels;
  pixels.reserve(positions.size());
  for (const Vector3d& position : positions) pixels.emplace_back(camera.project(position).cast<float>());
  return pixels;
}

/// Outward normals of the vertices, as long as twice the area around.
std::vector<Vector3d> area_normals(const std::vector<Vector3d>& positions, const VisibleSurface& surface) {
  std::vector<Vector3d> normals(positions.size(), Vector3d::Zero());
  for (const auto& [a, b, c] : surface.triangles) {
    const Vector3d normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const int corner : {a, b, c}) normals[corner] += normal;
  }
  return normals;
}

/// What a view shows of the surface, each in 0..1.
struct Visibility {
  double motion = 0;      ///< of the squared displacement
  double facing = 0;      ///< of the squared displacement, by the cosine between normal and view
  double touchable = 0;   ///< of the area that may be touched, likewise
  double fixed = 0;       ///< of the fixed vertices
  double silhouette = 0;  ///< of the picture
};

Visibility visibility(const VisibleSurface& surface, const std::vector<Vector3d>& displacement,
                      const std::vector<Vector3d>& positions, const std::vector<Vector3d>& normals,
                      const ViewFrame& frame) {
  constexpr int size = 96;
  constexpr float tolerance = 1.5F;  // pixels: a vertex lies on the triangles around it
  const Camera camera = fit_camera(frame, positions, size, 2);
  const auto pixels = projected(camera, positions);
  DepthBuffer buffer(camera.width, camera.height);
  buffer.draw(pixels, surface.triangles);

  double all_motion = 0, all_fixed = 0, all_touchable = 0;
  Visibility seen;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vector3d motion = i < displacement.size() ? displacement[i] : Vector3d::Zero();
    const bool visible =
        pixels[i].allFinite() &&
        pixels[i].z() >= buffer.depth(static_cast<int>(pixels[i].x()), static_cast<int>(pixels[i].y())) - tolerance;
    const double area = surface.touchable.empty() || surface.touchable[i] ? normals[i].norm() : 0;
    const double cosine = std::max(normals[i].normalized().dot(frame.towards), 0.0);
    all_motion += motion.squaredNorm();
    all_fixed += surface.fixed[i] ? 1 : 0;
    all_touchable += area;
    if (!visible) continue;
    seen.motion += motion.squaredNorm();
    seen.facing += cosine * motion.squaredNorm();
    seen.touchable += cosine * area;
    seen.fixed += surface.fixed[i] ? 1 : 0;
  }
  if (all_motion > 0) seen.motion /= all_motion, seen.facing /= all_motion;
  if (all_touchable > 0) seen.touchable /= all_touchable;
  if (all_fixed > 0) seen.fixed /= all_fixed;
  for (int y = 0; y < buffer.height(); ++y) {
    for (int x = 0; x < buffer.width(); ++x) seen.silhouette += buffer.triangle(x, y) != DepthBuffer::nothing ? 1 : 0;
  }
  seen.silhouette /= static_cast<double>(size) * size;
  return seen;
}

}  // namespace

ViewFrame view_frame(const Vector3d& towards, const Vector3d& up) {
  const Vector3d out = towards.normalized();
  Vector3d right = up.cross(out);
  if (right.norm() < 1e-6 * up.norm()) right = out.unitOrthogonal();
  right.normalize();
  return {right, out.cross(right), out};
}

Vector3d Camera::project(const Vector3d& point) const {
  const double x = (point.dot(frame.right) - low.x()) * scale;
  const double y = (point.dot(frame.up) - low.y()) * scale;
  return {x, height - y, point.dot(frame.towards) * scale};
}

Camera fit_camera(const ViewFrame& frame, const std::vector<Vector3d>& points, int longest, int margin) {
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d high = -low;
  for (const Vector3d& point : points) {
    const Eigen::Array2d flat(point.dot(frame.right), point.dot(frame.up));
    low = low.min(flat);
    high = high.max(flat);
  }
  if (points.empty()) low = high = 0;
  const Eigen::Array2d extent = (high - low).max(1e-9 * std::max(1e-300, (high - low).maxCoeff()));
  const double scale = (longest - 2 * margin) / std::max(extent.maxCoeff(), 1e-300);
  return {.frame = frame,
          .low = low - margin / scale,
          .scale = scale,
          .width = static_cast<int>(std::ceil(extent.x() * scale)) + 2 * margin,
          .height = static_cast<int>(std::ceil(extent.y() * scale)) + 2 * margin};
}

Vector3d upright(const VisibleSurface& surface) {
  Eigen::AlignedBox3d box;
  Vector3d fixed_sum = Vector3d::Zero();
  double fixed_count = 0;
  for (std::size_t i = 0; i < surface.positions.size(); ++i) {
    box.extend(surface.positions[i]);
    if (!surface.fixed[i]) continue;
    fixed_sum += surface.positions[i];
    fixed_count += 1;
  }
  int axis = 0;
  if (fixed_count > 0) {
    const Vector3d lead = box.center() - fixed_sum / fixed_count;
    const Vector3d relative = lead.cwiseQuotient(box.sizes().cwiseMax(1e-12 * box.diagonal().norm()));
    if (relative.cwiseAbs().maxCoeff(&axis) > 0.2) return std::copysign(1.0, lead[axis]) * Vector3d::Unit(axis);
  }
  box.sizes().maxCoeff(&axis);
  return Vector3d::Unit(axis);
}

ViewFrame choose_view(const VisibleSurface& surface, const std::vector<Vector3d>& displacement) {
  const auto positions = moved(surface, displacement);
  const auto normals = area_normals(positions, surface);
  const Vector3d up = upright(surface);
  const Vector3d ahead = up.unitOrthogonal(), aside = up.cross(ahead);
  ViewFrame best = view_frame(ahead, up);
  double best_score = -1;
  for (const double elevation : {15.0, 35.0, -10.0, 60.0, -40.0}) {
    for (double azimuth = 0; azimuth < 360; azimuth += 15) {
      const Vector3d level = std::cos(azimuth * radians) * ahead + std::sin(azimuth * radians) * aside;
      const ViewFrame frame =
          view_frame(std::cos(elevation * radians) * level + std::sin(elevation * radians) * up, up);
      const Visibility seen = visibility(surface, displacement, positions, normals, frame);
      const double steepness = std::abs(elevation - 15) / 90;
      const double score = seen.motion + 0.8 * seen.facing + 0.5 * seen.touchable + 0.3 * seen.silhouette +
                           0.25 * seen.fixed - 0.3 * steepness;
      if (score <= best_score + 1e-9) continue;
      best_score = score;
      best = frame;
    }
  }
  return best;
}

}  // namespace greenloop::offline
