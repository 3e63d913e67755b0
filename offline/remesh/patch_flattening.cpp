#include "offline/remesh/patch_flattening.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace greenloop::offline {
namespace {

using Places = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& u, const Eigen::Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); }

double twice_area(const std::array<Eigen::Vector2d, 3>& p) { return cross(p[1] - p[0], p[2] - p[0]); }

/// tan(angle / 2) at `apex` between the directions to a and b; at most 1,000.
double half_tangent(const Eigen::Vector3d& apex, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d u = a - apex, v = b - apex;
  const double sine = u.cross(v).norm(), one_plus_cosine = u.norm() * v.norm() + u.dot(v);
  return sine < 1e3 * one_plus_cosine ? sine / one_plus_cosine : 1e3;
}

/// Mean value weights of the patch vertices around `center`, normalised to sum 1.
std::vector<double> mean_value_weights(const CollapsePatch& patch, const std::vector<PatchTriangle>& triangles,
                                       int center) {
  std::vector<double> weights(patch.vertices.size(), 0.0);
  double total = 0;
  for (const auto& [triangle, corners] : triangles) {
    for (int c = 0; c < 3; ++c) {
      if (corners[c] != center) continue;
      const int a = corners[(c + 1) % 3], b = corners[(c + 2) % 3];
      const auto& apex = patch.vertices[center];
      const double tangent = std::max(1e-3, half_tangent(apex, patch.vertices[a], patch.vertices[b]));
      for (const int end : {a, b}) {
        const double weight = tangent / std::max((patch.vertices[end] - apex).norm(), 1e-12);
        weights[end] += weight;
        total += weight;
      }
    }
  }
  for (auto& weight : weights) weight /= total;
  return weights;
}

/// Places both ends of the collapsed edge at the mean value combination of their neighbours.
void place_collapsed_ends(const CollapsePatch& patch, Places& places) {
  const int first = patch.outline, second = patch.outline + 1;
  const auto of_first = mean_value_weights(patch, patch.before, first);
  const auto of_second = mean_value_weights(patch, patch.before, second);
  Eigen::Vector2d fixed_first = Eigen::Vector2d::Zero(), fixed_second = Eigen::Vector2d::Zero();
  for (int b = 0; b < patch.outline; ++b) {
    fixed_first += of_first[b] * places[b];
    fixed_second += of_second[b] * places[b];
  }
  const double coupling = 1 - of_first[second] * of_second[first];
  places[first] = (fixed_first + of_first[second] * fixed_second) / coupling;
  places[second] = (fixed_second + of_second[first] * fixed_first) / coupling;
}

/// The remaining vertex at the origin, its fan by z^a; false if an angle comes near a half turn.
bool place_outline_by_polar_map(const CollapsePatch& patch, Places& places) {
  const auto& apex = patch.vertices[patch.outline + 2];
  std::vector<double> angles;
  double whole = 0, mean_radius = 0;
  for (int b = 0; b < patch.outline; ++b) {
    const Eigen::Vector3d u = patch.vertices[b] - apex, v = patch.vertices[(b + 1) % patch.outline] - apex;
    angles.push_back(std::atan2(u.cross(v).norm(), u.dot(v)));
    whole += angles.back();
    mean_radius += u.norm() / patch.outline;
  }
  if (!(whole > 0) || !(mean_radius > 0)) return false;
  const double exponent = 2 * std::numbers::pi / whole;
  double direction = 0;
  for (int b = 0; b < patch.outline; ++b) {
    const double radius = std::pow((patch.vertices[b] - apex).norm() / mean_radius, exponent);
    places[b] = radius * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    direction += exponent * angles[b];
    if (exponent * angles[b] > 0.95 * std::numbers::pi) return false;
  }
  places[patch.outline + 2].setZero();
  return true;
}

void place_outline_on_circle(const CollapsePatch& patch, Places& places) {
  std::vector<double> lengths;
  double whole = 0;
  for (int b = 0; b < patch.outline; ++b) {
    lengths.push_back((patch.vertices[(b + 1) % patch.outline] - patch.vertices[b]).norm());
    whole += lengths.back();
  }
  double direction = 0;
  for (int b = 0; b < patch.outline; ++b) {
    places[b] = {std::cos(direction), std::sin(direction)};
    // halfway between chord-length and uniform spacing: no arc degenerates
    direction += std::numbers::pi * (lengths[b] / whole + 1.0 / patch.outline);
  }
  const int remaining = patch.outline + 2;
  const auto weights = mean_value_weights(patch, patch.after, remaining);
  places[remaining].setZero();
  for (int b = 0; b < patch.outline; ++b) places[remaining] += weights[b] * places[b];
}

std::vector<FlatTriangle> laid_out(const std::vector<PatchTriangle>& triangles, const Places& places) {
  std::vector<FlatTriangle> flat;
  flat.reserve(triangles.size());
  for (const auto& [triangle, corners] : triangles) {
    flat.push_back({triangle, {places[corners[0]], places[corners[1]], places[corners[2]]}});
  }
  return flat;
}

/// Every triangle has at least `share` of the mean area.
bool unfolded(const std::vector<FlatTriangle>& triangles, double share) {
  double whole = 0, least = std::numeric_limits<double>::infinity();
  for (const auto& flat : triangles) {
    const double area = twice_area(flat.corners);
    whole += area;
    least = std::min(least, area);
  }
  return least > share * whole / static_cast<double>(triangles.size()) && whole > 0;
}

/// The first end between the second, which stays, and where its line comes from, or its neighbours' mean value.
std::optional<FlatPatch> flattened_towards_second(const CollapsePatch& patch, Places places, double share) {
  const int first = patch.outline, second = patch.outline + 1;
  places[second] = places[patch.outline + 2];
  const double to_second = (patch.vertices[second] - patch.vertices[first]).norm();
  Eigen::Vector2d away = Eigen::Vector2d::Zero();
  if (patch.line >= 0) {
    const double to_line = (patch.vertices[patch.line] - patch.vertices[first]).norm();
    away = to_second / (to_second + to_line) * (places[patch.line] - places[second]);
  } else {
    const auto weights = mean_value_weights(patch, patch.before, first);
    for (int b = 0; b <= patch.outline + 1; ++b) {
      if (b != first) away += weights[b] * (places[b] - places[second]);
    }
  }
  for (int halvings = 0; halvings < 12; ++halvings, away /= 2) {
    places[first] = places[second] + away;
    FlatPatch flat{laid_out(patch.before, places), laid_out(patch.after, places)};
    if (unfolded(flat.before, std::ldexp(share, -halvings)) && unfolded(flat.after, share)) return flat;
  }
  return std::nullopt;
}

}  // namespace

std::optional<FlatPatch> flatten(const CollapsePatch& patch) {
  Places places(patch.outline + 3);
  if (place_outline_by_polar_map(patch, places)) {
    place_collapsed_ends(patch, places);
    FlatPatch flat{laid_out(patch.before, places), laid_out(patch.after, places)};
    if (unfolded(flat.before, 1e-3) && unfolded(flat.after, 1e-3)) return flat;
  }
  place_outline_on_circle(patch, places);
  place_collapsed_ends(patch, places);
  FlatPatch flat{laid_out(patch.before, places), laid_out(patch.after, places)};
  if (unfolded(flat.before, 1e-9) && unfolded(flat.after, 1e-9)) return flat;
  return std::nullopt;
}

std::optional<FlatPatch> flatten_onto_second(const CollapsePatch& patch) {
  Places places(patch.outline + 3);
  if (place_outline_by_polar_map(patch, places)) {
    if (auto flat = flattened_towards_second(patch, places, 1e-3)) return flat;
  }
  place_outline_on_circle(patch, places);
  return flattened_towards_second(patch, places, 1e-6);
}

FlatLocation locate(const std::vector<FlatTriangle>& triangulation, const Eigen::Vector2d& place) {
  FlatLocation best;
  double best_margin = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < triangulation.size(); ++k) {
    const auto& p = triangulation[k].corners;
    const Eigen::Vector3d weights =
        Eigen::Vector3d(cross(p[1] - place, p[2] - place), cross(p[2] - place, p[0] - place),
                        cross(p[0] - place, p[1] - place)) /
        twice_area(p);
    if (weights.minCoeff() > best_margin) {
      best_margin = weights.minCoeff();
      best = {k, weights};
    }
  }
  const Eigen::Vector3d positive = best.weights.cwiseMax(0.0);
  best.weights = positive / positive.sum();
  return best;
}

}  // namespace greenloop::offline
