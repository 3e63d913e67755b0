#include "offline/remesh/remesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "offline/remesh/midpoint_refinement.hpp"
#include "offline/remesh/relaxation.hpp"
#include "offline/remesh/self_parameterization.hpp"
#include "offline/remesh/subdivision_connectivity.hpp"
#include "offline/remesh/surface.hpp"

namespace greenloop::offline {
namespace {

/// By what the base grows from attempt to attempt, against the size asked for.
constexpr std::array kGrowth{1.0, 1.1, 1.19, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0};

/// Fewer levels than this leave triangles too large to be shaped by the surface below them.
constexpr int kWorkingLevels = 3;

double accuracy_of(const RemeshOptions& options) {
  constexpr double at_base = 0.16;
  return options.accuracy.value_or(std::ldexp(at_base, -options.levels));
}

void require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument("remesh: " + message);
}

void check(const TriangleMesh& input, const RemeshOptions& options) {
  require(options.base_vertices >= 4, "base_vertices = " + std::to_string(options.base_vertices) + "; at least 4");
  require(options.levels >= 0 && options.levels <= 7, "levels = " + std::to_string(options.levels) + "; 0 to 7");
  require(accuracy_of(options) > 0, "accuracy = " + std::to_string(accuracy_of(options)) + "; must be above 0");
  require(!input.triangles.empty(), "the surface has no triangles");
  require(input.vertices.size() < 2 * input.triangles.size(), "the surface has vertices that no triangle uses");
}

/// Lengths in units of the bounding box's diagonal: nothing below depends on the unit of the file.
struct Normalization {
  Eigen::Vector3d origin;
  double diagonal;

  explicit Normalization(const TriangleMesh& mesh) {
    Eigen::AlignedBox3d box;
    for (const auto& vertex : mesh.vertices) box.extend(vertex);
    origin = box.center();
    diagonal = box.diagonal().norm();
    require(diagonal > 0 && std::isfinite(diagonal), "the surface has no extent, or coordinates that are not finite");
  }
  [[nodiscard]] TriangleMesh apply(TriangleMesh mesh) const {
    for (auto& vertex : mesh.vertices) vertex = (vertex - origin) / diagonal;
    return mesh;
  }
};

std::string place(const Eigen::Vector3d& p) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.3g, %.3g, %.3g)", p.x(), p.y(), p.z());
  return text;
}

std::string failure(const RemeshQuality& reached, const RemeshOptions& options) {
  char text[768];
  std::snprintf(text, sizeof text,
                "remesh: %d levels over a base of %d to %d vertices do not resolve this shape. Last reached: smallest "
                "angle %.3g degrees at %s, Hausdorff distance %.3g %% of the diagonal at %s, %zu flipped triangles%s, "
                "%zu self-intersections; wanted: at least %.3g degrees, at most %.3g %%, none and none (places are "
                "fractions of the bounding box). Raise remesh.levels (now %d) or remesh.base_vertices (now %d); if "
                "there are needles or features thinner than a finest triangle, remesh the input evenly or thicken it",
                options.levels, options.base_vertices, reached.base_vertices, reached.smallest_angle_degrees,
                place(reached.smallest_angle_at).c_str(), 100 * reached.hausdorff_relative,
                place(reached.hausdorff_at).c_str(), reached.flipped,
                reached.flipped > 0 ? (" around " + place(reached.flipped_at)).c_str() : "", reached.self_intersections,
                options.smallest_angle, 100 * accuracy_of(options), options.levels, options.base_vertices);
  return text;
}

bool acceptable(const RemeshQuality& quality, const RemeshOptions& options) {
  return quality.flipped == 0 && quality.self_intersections == 0 &&
         quality.smallest_angle_degrees >= options.smallest_angle && quality.hausdorff_relative <= accuracy_of(options);
}

/// `mesh` as a base and `levels` splits of it, in the triangles' own planes.
SemiRegularMesh split(const TriangleMesh& mesh, int levels) {
  auto result = refine_midpoints(mesh.triangles, static_cast<int>(mesh.vertices.size()), levels).mesh;
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), result.positions.begin());
  for (std::size_t v = mesh.vertices.size(); v < result.positions.size(); ++v) {
    const auto& [a, b] = result.parents[v];
    result.positions[v] = (result.positions[a] + result.positions[b]) / 2;
  }
  return result;
}

/// The number of vertices after one split of a closed surface.
std::size_t vertices_after_split(const TriangleMesh& mesh) {
  return mesh.vertices.size() + 3 * mesh.triangles.size() / 2;
}

TriangleMesh split_once(const TriangleMesh& mesh) {
  auto finer = split(mesh, 1);
  auto triangles = triangles_of_level(finer, 1);
  return {std::move(finer.positions), std::move(triangles)};
}

/// The input's own triangles, split as often as a base of `base_vertices` allows, as the base.
SemiRegularMesh exact(TriangleMesh input, int base_vertices, int levels) {
  while (vertices_after_split(input) <= static_cast<std::size_t>(base_vertices)) input = split_once(input);
  return split(input, levels);
}

/// The input in triangles small enough to be decimated to `base_vertices`.
TriangleMesh with_enough_vertices(TriangleMesh input, int base_vertices) {
  while (input.vertices.size() < 2 * static_cast<std::size_t>(base_vertices)) input = split_once(input);
  return input;
}

/// One attempt; `surface` holds the input in normalised coordinates.
SemiRegularMesh attempt(const TriangleMesh& input, const Surface& surface, int base_vertices, int levels,
                        const std::function<void(double)>& progress) {
  const auto parameterization = decimate(surface.mesh(), base_vertices);
  auto refinement =
      refine_midpoints(parameterization.base_triangles, static_cast<int>(parameterization.base_vertices.size()),
                       std::max(levels, kWorkingLevels));
  const auto points = relax(surface, refinement.mesh, parameterization.to_input(std::move(refinement.places)),
                            parameterization.base_planes, progress);
  auto& positions = refinement.mesh.positions;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const auto& [a, b, c] = input.triangles[points[v].triangle];
    const auto& w = points[v].weights;
    positions[v] = w[0] * input.vertices[a] + w[1] * input.vertices[b] + w[2] * input.vertices[c];
  }
  return truncated(std::move(refinement.mesh), levels);
}

}  // namespace

Remeshed remesh(const TriangleMesh& input, const RemeshOptions& options, const Progress& progress) {
  check(input, options);
  const auto report = [&](double fraction, std::string_view stage) {
    if (progress) progress(fraction, stage);
  };
  report(0, "looking for subdivision connectivity");
  if (options.keep_connectivity) {
    if (auto found = find_subdivision_connectivity(input, options.levels)) {
      Remeshed kept{std::move(*found), {}};
      kept.quality = measure_quality(input, kept.mesh);
      kept.quality.kept_connectivity = true;
      report(1, "kept the surface's own subdivision connectivity");
      return kept;
    }
  }
  const Normalization normalization(input);
  std::optional<Surface> surface;
  TriangleMesh fine;
  const int most = options.most_base_vertices.value_or(static_cast<int>(kGrowth.back()) * options.base_vertices);
  double done = 0;
  bool tried_exact = false;
  RemeshQuality reached;
  for (const double growth : kGrowth) {
    const int base_vertices = static_cast<int>(std::lround(growth * options.base_vertices));
    if (base_vertices > std::max(most, options.base_vertices)) break;
    if (!tried_exact && input.vertices.size() <= static_cast<std::size_t>(base_vertices)) {
      Remeshed result{exact(input, base_vertices, options.levels), {}};
      result.quality = measure_quality(input, result.mesh);
      result.quality.flipped = 0;  // no triangle leaves the input's own; smooth normals mislead on so few
      if (acceptable(result.quality, options)) {
        report(1, "split the surface's own triangles");
        return result;
      }
      tried_exact = true;
    }
    if (!surface || fine.vertices.size() < 2 * static_cast<std::size_t>(base_vertices)) {
      fine = with_enough_vertices(input, base_vertices);
      surface.emplace(normalization.apply(fine));
    }
    const double share = (1 - done) / 2;  // how many attempts there will be is not known
    Remeshed result;
    result.mesh = attempt(fine, *surface, base_vertices, options.levels, [&](double fraction) {
      report(done + share * fraction, "sliding " + std::to_string(base_vertices) + " base vertices and their splits");
    });
    done += share;
    report(done, "measuring");
    result.quality = measure_quality(input, result.mesh);
    if (acceptable(result.quality, options)) {
      report(1, "remeshed");
      return result;
    }
    reached = result.quality;
  }
  throw std::runtime_error(failure(reached, options));
}

}  // namespace greenloop::offline
