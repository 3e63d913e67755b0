#include "offline/remesh/remesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "offline/remesh/feature_curves.hpp"
#include "offline/remesh/ground.hpp"
#include "offline/remesh/midpoint_refinement.hpp"
#include "offline/remesh/self_parameterization.hpp"
#include "offline/remesh/subdivision_connectivity.hpp"
#include "offline/surface/area_and_volume.hpp"

namespace greenloop::offline {
namespace {

/// By what the base grows from attempt to attempt, against the size asked for: on the input's own triangles, and on
/// even ones. No step below kBigStep follows an attempt that crosses itself or is turned over; a base of twice the size
/// follows one that misses the accuracy by more than kFarMiss.
constexpr std::array kGrowth{1.0, 1.1, 1.19, 1.4, 2.0, 2.8, 4.0};
constexpr std::array kEvenGrowth{1.0, 1.4, 2.0, 2.8};
constexpr double kBigStep = 1.4, kFarMiss = 2;
constexpr int kMostGrowth = 8;

/// Attempts that keep the drawing's edges, each over this many times the base of the one before.
constexpr int kFeatureAttempts = 4;
constexpr double kFeatureGrowth = 1.4;
/// Edges that need more than this many times the base asked for, and than a base without them that will do, are left.
constexpr int kFeatureBase = 2;

/// An attempt's work is counted in vertices moved; a vertex of the ground is worth kGroundWork of them.
constexpr double kSweeps = 60, kGroundWork = 15;

/// Turn of the surface at an edge of the drawing, degrees; and the least length of a line of them, in diagonals.
constexpr double kSharp = 40, kShortestLine = 0.1;
/// Mean length of the lines of a drawing, in diagonals: the creases of a scan or of a coarse animal are shorter.
constexpr double kDrawnLine = 0.15;

/// Angles below this, in degrees, make needles.
constexpr double kNeedle = 1;
/// A ground over which an attempt crosses itself in more places than this, or this many if it has needles, will not do
/// with a larger base either.
constexpr std::size_t kHopeless = 1000, kHopelessNeedles = 100;

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
  [[nodiscard]] TriangleMesh undo(TriangleMesh mesh) const {
    for (auto& vertex : mesh.vertices) vertex = origin + diagonal * vertex;
    return mesh;
  }
};

std::string place(const Eigen::Vector3d& p) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.3g, %.3g, %.3g)", p.x(), p.y(), p.z());
  return text;
}

std::string failure(const RemeshQuality& reached, int largest, const RemeshOptions& options) {
  char text[1024];
  std::snprintf(
      text, sizeof text,
      "remesh: %d levels over a base of %d or more vertices do not resolve this shape. Best reached, over %d: "
      "smallest angle %.3g degrees at %s, Hausdorff distance %.3g %% of the diagonal at %s, %zu flipped "
      "triangles%s, %zu self-intersections; wanted: at least %.3g degrees, at most %.3g %%, none and none "
      "(places are fractions of the bounding box). Raise remesh.levels (now %d) or remesh.base_vertices (now "
      "%d; the next that was not tried is %d); where a part is thinner than a finest triangle, thicken it",
      options.levels, options.base_vertices, reached.base_vertices, reached.smallest_angle_degrees,
      place(reached.smallest_angle_at).c_str(), 100 * reached.hausdorff_relative, place(reached.hausdorff_at).c_str(),
      reached.flipped, reached.flipped > 0 ? (" around " + place(reached.flipped_at)).c_str() : "",
      reached.self_intersections, options.smallest_angle, 100 * accuracy_of(options), options.levels,
      options.base_vertices, static_cast<int>(std::lround(kBigStep * std::max(largest, options.base_vertices))));
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

/// Vertices of the finest level over a base, of three levels at least.
double finest_vertices(double base_vertices, int levels) { return std::ldexp(base_vertices, 2 * std::max(levels, 3)); }

/// Triangles of an even ground: a few times smaller than the finest ones.
double even_triangles(const RemeshOptions& options) {
  constexpr double kFiner = 6, kFewest = 2e4, kMost = 2e5;
  return std::clamp(kFiner * 2 * finest_vertices(options.base_vertices, options.levels), kFewest, kMost);
}

/// The edge of equilateral triangles, so many of which have an area together.
double equilateral_edge(double area, double triangles) { return std::sqrt(4 / std::sqrt(3.0) * area / triangles); }

double even_edge(const TriangleMesh& normalized, const RemeshOptions& options) {
  return equilateral_edge(surface_area(normalized), even_triangles(options));
}

double work_of_attempt(double base_vertices, int levels, double ground_vertices) {
  return kSweeps * finest_vertices(base_vertices, levels) + kGroundWork * ground_vertices;
}

double most_work(const TriangleMesh& input, const RemeshOptions& options) {
  const double ground = std::max(even_triangles(options) / 2, static_cast<double>(input.vertices.size()));
  return options.most_work * work_of_attempt(options.base_vertices, options.levels, ground);
}

/// Whether the surface is made of faces that meet in edges, as drawings are.
bool is_drawn(const Features& features) {
  double length = 0;
  for (const auto& chain : features.chains) length += chain.lengths.back();
  return length > 0 && length >= kDrawnLine * static_cast<double>(features.chains.size());
}

/// Attempts one after the other, and the best of those that would not do.
class Search {
 public:
  Search(const TriangleMesh& input, const RemeshOptions& options, const Progress& progress)
      : input_(input), options_(options), progress_(progress), normalization_(input) {}

  std::optional<Remeshed> run() {
    if (auto found = exactly(options_.base_vertices)) return found;
    const auto normalized = normalization_.apply(input_);
    const auto features = find_features(normalized, kSharp, kShortestLine);
    if (is_drawn(features)) {
      const Ground drawn(normalized, features, even_edge(normalized, options_));
      if (!drawn.settled()) return without_features(normalized, most_base());
      if (auto found = with_features(drawn, std::min(kFeatureBase * options_.base_vertices, most_base()))) return found;
      if (auto found = without_features(normalized, std::min(feature_vertices() / kFeatureBase, most_base())))
        return found;
      if (auto found = with_features(drawn, most_base())) return found;
    }
    return without_features(normalized, most_base());
  }

  void report(double fraction, std::string_view stage) const {
    if (progress_) progress_(fraction, stage);
  }

  [[nodiscard]] const RemeshQuality& best() const { return *best_; }
  [[nodiscard]] int largest_base() const { return largest_base_; }

 private:
  [[nodiscard]] int most_base() const {
    const int most = options_.most_base_vertices.value_or(kMostGrowth * options_.base_vertices);
    return std::max(most, options_.base_vertices);
  }

  /// The input's own triangles as the base, if it has no more vertices than that.
  std::optional<Remeshed> exactly(int base_vertices) {
    if (tried_exactly_ || input_.vertices.size() > static_cast<std::size_t>(base_vertices)) return std::nullopt;
    tried_exactly_ = true;
    Remeshed result{exact(input_, base_vertices, options_.levels), {}};
    result.quality = measure_quality(input_, result.mesh);
    result.quality.flipped = 0;  // no triangle leaves the input's own; smooth normals mislead on so few
    if (!acceptable(result.quality, options_)) return std::nullopt;
    report(1, "split the surface's own triangles");
    return result;
  }

  /// The least base that keeps the features, and larger ones, of at most `most` vertices; goes on where it stopped.
  std::optional<Remeshed> with_features(const Ground& ground, int most) {
    for (; feature_attempts_ < kFeatureAttempts; ++feature_attempts_) {
      if (!feature_base_) feature_base_ = ground.base(options_.base_vertices);
      const int vertices = feature_vertices();
      if (vertices > most || !affords(ground, vertices)) break;
      if (auto found = over(ground, input_, *feature_base_)) return found;
      if (last_.self_intersections > kHopeless) {
        feature_attempts_ = kFeatureAttempts;
        break;
      }
      feature_base_ = ground.base(static_cast<int>(std::lround(kFeatureGrowth * vertices)));
    }
    return std::nullopt;
  }

  [[nodiscard]] int feature_vertices() const { return static_cast<int>(feature_base_->base_vertices.size()); }

  /// Bases of at most `most` vertices on the input's own triangles, then on even ones; goes on where it stopped.
  std::optional<Remeshed> without_features(const TriangleMesh& normalized, int most) {
    if (auto found = on_own_triangles(most)) return found;
    return on_even_triangles(normalized, most);
  }

  [[nodiscard]] int grown(double growth) const {
    return static_cast<int>(std::lround(growth * options_.base_vertices));
  }

  std::optional<Remeshed> on_own_triangles(int most) {
    const bool needles = smallest_angle(input_) < kNeedle;
    while (own_attempts_ < kGrowth.size() && grown(kGrowth[own_attempts_]) <= most) {
      const int base_vertices = grown(kGrowth[own_attempts_]);
      if (auto found = exactly(base_vertices)) return found;
      if (!own_ || own_mesh_.vertices.size() < 2 * static_cast<std::size_t>(base_vertices)) {
        own_mesh_ = with_enough_vertices(input_, base_vertices);
        own_ = std::make_unique<Ground>(normalization_.apply(own_mesh_));
      }
      if (!affords(*own_, base_vertices)) break;
      if (auto found = over(*own_, own_mesh_, own_->base(base_vertices))) return found;
      own_attempts_ = after(own_attempts_, kGrowth);
      if (last_.self_intersections > (needles ? kHopelessNeedles : kHopeless)) own_attempts_ = kGrowth.size();
    }
    return std::nullopt;
  }

  std::optional<Remeshed> on_even_triangles(const TriangleMesh& normalized, int most) {
    while (even_attempts_ < kEvenGrowth.size() && grown(kEvenGrowth[even_attempts_]) <= most) {
      if (!even_) {
        const Features none{{}, std::vector<char>(input_.vertices.size(), 0)};
        even_ = std::make_unique<Ground>(normalized, none, even_edge(normalized, options_));
      }
      if (!even_->settled()) break;
      const int base_vertices = grown(kEvenGrowth[even_attempts_]);
      if (!affords(*even_, base_vertices)) break;
      if (auto found = over(*even_, input_, even_->base(base_vertices))) return found;
      even_attempts_ = after(even_attempts_, kEvenGrowth);
      if (last_.self_intersections > kHopeless) even_attempts_ = kEvenGrowth.size();
    }
    return std::nullopt;
  }

  /// The attempt to follow the last one, which was number k.
  [[nodiscard]] std::size_t after(std::size_t k, std::span<const double> growth) const {
    const bool crosses = last_.flipped > 0 || last_.self_intersections > 0;
    const double miss = last_.hausdorff_relative / accuracy_of(options_);
    const double least = miss > kFarMiss ? 2 * growth[k] : crosses ? kBigStep : 0;
    ++k;
    while (k < growth.size() && growth[k] < least) ++k;
    return k;
  }

  [[nodiscard]] double work_over(const Ground& ground, int base_vertices) const {
    return work_of_attempt(base_vertices, options_.levels,
                           static_cast<double>(ground.surface().mesh().vertices.size()));
  }

  /// Whether an attempt is within the work allowed; the first one is.
  [[nodiscard]] bool affords(const Ground& ground, int base_vertices) const {
    return !best_ || work_ + work_over(ground, base_vertices) <= most_work(input_, options_);
  }

  /// One attempt; `own` has the triangles that the ground's places refer to.
  std::optional<Remeshed> over(const Ground& ground, const TriangleMesh& own, const SelfParameterization& base) {
    const auto base_vertices = base.base_vertices.size();
    work_ += work_over(ground, static_cast<int>(base_vertices));
    largest_base_ = std::max(largest_base_, static_cast<int>(base_vertices));
    const double share = (1 - done_) / 2;  // how many attempts there will be is not known
    const double least = options_.smallest_angle * std::numbers::pi / 180;
    auto attempt = ground.attempt(base, options_.levels, least, [&](double fraction) {
      report(done_ + share * fraction, "sliding " + std::to_string(base_vertices) + " base vertices and their splits");
    });
    auto& positions = attempt.mesh.positions;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const auto& [a, b, c] = own.triangles[attempt.places[v].triangle];
      const auto& w = attempt.places[v].weights;
      positions[v] = w[0] * own.vertices[a] + w[1] * own.vertices[b] + w[2] * own.vertices[c];
    }
    done_ += share;
    report(done_, "measuring");
    last_ = measure_quality(input_, attempt.mesh);
    if (acceptable(last_, options_)) {
      report(1, "remeshed");
      return Remeshed{std::move(attempt.mesh), last_};
    }
    if (!best_ || faults(last_) < faults(*best_)) best_ = last_;
    return std::nullopt;
  }

  [[nodiscard]] std::pair<std::size_t, double> faults(const RemeshQuality& quality) const {
    return {quality.flipped + quality.self_intersections,
            std::max(options_.smallest_angle / std::max(quality.smallest_angle_degrees, 1e-9),
                     quality.hausdorff_relative / accuracy_of(options_))};
  }

  const TriangleMesh& input_;
  const RemeshOptions& options_;
  const Progress& progress_;
  Normalization normalization_;
  double done_ = 0;
  bool tried_exactly_ = false;
  std::optional<SelfParameterization> feature_base_;  ///< the next to be tried
  int feature_attempts_ = 0;
  TriangleMesh own_mesh_;
  std::unique_ptr<Ground> own_, even_;
  std::size_t own_attempts_ = 0, even_attempts_ = 0;
  double work_ = 0;  ///< of all attempts
  int largest_base_ = 0;
  RemeshQuality last_;
  std::optional<RemeshQuality> best_;
};

/// Whether a surface's own levels are those asked for, over a base of a size that might have been found.
bool serves(const SemiRegularMesh& found, const RemeshOptions& options) {
  const int most = options.most_base_vertices.value_or(kMostGrowth * options.base_vertices);
  return found.finest_level() == options.levels &&
         found.vertex_end.front() <= static_cast<std::size_t>(std::max(most, options.base_vertices));
}

}  // namespace

double finest_edge(double area, const RemeshOptions& options) {
  return equilateral_edge(area, 2 * std::ldexp(options.base_vertices, 2 * options.levels));
}

Remeshed remesh(const TriangleMesh& input, const RemeshOptions& options, const Progress& progress) {
  check(input, options);
  Search search(input, options, progress);
  search.report(0, "looking for subdivision connectivity");
  if (options.keep_connectivity) {
    auto found = find_subdivision_connectivity(input, options.levels);
    if (found && serves(*found, options)) {
      Remeshed kept{std::move(*found), {}};
      kept.quality = measure_quality(input, kept.mesh);
      kept.quality.kept_connectivity = true;
      search.report(1, "kept the surface's own subdivision connectivity");
      return kept;
    }
  }
  if (auto found = search.run()) return *std::move(found);
  throw RemeshError(failure(search.best(), search.largest_base(), options), search.best());
}

TriangleMesh even_surface(const TriangleMesh& input, double edge_length) {
  constexpr double fewest_triangles = 100;
  const Normalization normalization(input);
  const TriangleMesh normalized = normalization.apply(input);
  const double longest = std::sqrt(4 / std::numbers::sqrt3 * surface_area(normalized) / fewest_triangles);
  const Ground ground(normalized, find_features(normalized, kSharp, kShortestLine),
                      std::min(edge_length / normalization.diagonal, longest));
  if (!ground.settled()) {
    throw std::runtime_error("a wall inside the body does not come to even triangles; mesh it more evenly");
  }
  return normalization.undo(ground.surface().mesh());
}

}  // namespace greenloop::offline
