#include "offline/remesh/relaxation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "offline/remesh/triangle_tree.hpp"

namespace greenloop::offline {
namespace {

constexpr int kSweeps = 60;
constexpr int kFirstLook = 10, kLookEvery = 5;  ///< sweeps after which the input's distance is looked at
constexpr double kTolerance = 0.003;            ///< distance that shrinks a triangle, in diagonals
constexpr double kMostWeight = 6;               ///< how many times smaller than the mean a triangle is asked to be
constexpr double kAnchor = 3;                   ///< weight of a base vertex's distance from the planes it stands for
constexpr double kPull = 20;                    ///< weight of a vertex's distance from the place it is to come to

struct Weighted {
  int vertex;
  double weight;
};

/// What moves with one vertex of one level: finest vertices by hat-function weight, finest triangles touched.
struct Patch {
  int center = 0;
  std::vector<Weighted> members;
  std::vector<int> triangles;
  std::vector<int> base;
};

/// Hat functions of every vertex of `level` over the finest level.
std::vector<Patch> hat_patches(const SemiRegularMesh& mesh, int level, const std::vector<std::vector<int>>& around) {
  const std::size_t coarse = mesh.vertex_end[level];
  std::vector<std::vector<Weighted>> rows(mesh.parents.size());
  std::vector<Patch> patches(coarse);
  for (std::size_t v = 0; v < mesh.parents.size(); ++v) {
    auto& row = rows[v];
    if (v < coarse) {
      row.push_back({static_cast<int>(v), 1.0});
    } else {
      for (const int parent : mesh.parents[v]) {
        for (const auto& [vertex, weight] : rows[parent]) {
          const auto same =
              std::find_if(row.begin(), row.end(), [v = vertex](const Weighted& w) { return w.vertex == v; });
          if (same == row.end()) {
            row.push_back({vertex, weight / 2});
          } else {
            same->weight += weight / 2;
          }
        }
      }
    }
    for (const auto& [vertex, weight] : row) patches[vertex].members.push_back({static_cast<int>(v), weight});
  }
  for (std::size_t v = 0; v < coarse; ++v) {
    auto& patch = patches[v];
    patch.center = static_cast<int>(v);
    for (const auto& member : patch.members) {
      if (member.vertex < static_cast<int>(mesh.vertex_end[0])) patch.base.push_back(member.vertex);
      patch.triangles.insert(patch.triangles.end(), around[member.vertex].begin(), around[member.vertex].end());
    }
    std::sort(patch.triangles.begin(), patch.triangles.end());
    patch.triangles.erase(std::unique(patch.triangles.begin(), patch.triangles.end()), patch.triangles.end());
  }
  return patches;
}

Eigen::Vector3d position_on(const TriangleMesh& mesh, const SurfacePoint& place) {
  const auto& [a, b, c] = mesh.triangles[place.triangle];
  return place.weights[0] * mesh.vertices[a] + place.weights[1] * mesh.vertices[b] +
         place.weights[2] * mesh.vertices[c];
}

class Relaxation {
 public:
  Relaxation(const Surface& surface, const FeatureCurves& curves, const SemiRegularMesh& mesh,
             std::vector<BoundPoint> points, const std::vector<Quadric>& base_planes)
      : surface_(surface),
        curves_(curves),
        points_(std::move(points)),
        triangles_(triangles_of_level(mesh, mesh.finest_level())),
        base_planes_(base_planes) {
    std::vector<std::vector<int>> around(points_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (const int v : triangles_[t]) around[v].push_back(static_cast<int>(t));
    }
    for (int level = 0; level <= mesh.finest_level(); ++level) patches_.push_back(hat_patches(mesh, level, around));
    weights_.assign(triangles_.size(), 1.0);
    positions_.resize(points_.size());
    normals_.resize(points_.size());
    for (std::size_t v = 0; v < points_.size(); ++v) place(static_cast<int>(v), points_[v]);
    double area = 0;
    const auto& input = surface.mesh();
    for (const auto& [a, b, c] : input.triangles) {
      area += (input.vertices[b] - input.vertices[a]).cross(input.vertices[c] - input.vertices[a]).norm() / 2;
    }
    find_witnesses();
    anchor_weight_ = kAnchor * static_cast<double>(triangles_.size()) / area;
    ideal_area_ = area / static_cast<double>(triangles_.size());
    targets_.assign(points_.size(), -1);
    pull_ = kPull / ideal_area_;
  }

  /// Gives the input's vertices that stand out by more than `tolerance`, farthest first, a vertex to come to them.
  void aim_at_far(double tolerance) {
    const TriangleMesh now{positions_, triangles_};
    const TriangleTree tree(now);
    const auto& input = surface_.mesh().vertices;
    std::vector<std::pair<double, int>> far;
    for (std::size_t i = 0; i < input.size(); ++i) {
      const double distance = (position_on(now, tree.closest(input[i])) - input[i]).norm();
      if (distance > tolerance) far.emplace_back(-distance, static_cast<int>(i));
    }
    std::sort(far.begin(), far.end());
    const double apart = 2 * std::sqrt(ideal_area_ * 4 / std::sqrt(3.0));
    std::vector<int> taken;
    std::copy_if(targets_.begin(), targets_.end(), std::back_inserter(taken), [](int t) { return t >= 0; });
    for (const auto& [minus, i] : far) {
      if (std::any_of(taken.begin(), taken.end(), [&, i = i](int t) { return (input[t] - input[i]).norm() < apart; }))
        continue;
      const int nearest = nearest_without_target(tree.closest(input[i]).triangle, input[i]);
      if (nearest < 0) continue;
      targets_[nearest] = i;
      taken.push_back(i);
    }
  }

  /// One pass over all vertices of all levels.
  void sweep() {
    regularize();
    for (std::size_t level = 0; level < patches_.size(); ++level) {
      const double finer = std::ldexp(1.0, static_cast<int>(patches_.size() - 1 - level));
      const double reach = 0.5 * finer * std::sqrt(ideal_area_ * 4 / std::sqrt(3.0));
      for (const auto& patch : patches_[level]) move(patch, reach);
    }
  }

  /// Raises the weight of triangles that the input sticks out of by more than `tolerance`, so that they shrink.
  void refine_where_far(double tolerance) {
    const TriangleMesh now{positions_, triangles_};
    const TriangleTree tree(now);
    std::vector<double> rise(triangles_.size(), 0.0);
    for (const auto& vertex : surface_.mesh().vertices) {
      const auto place = tree.closest(vertex);
      const double distance = (position_on(now, place) - vertex).norm();
      auto& here = rise[place.triangle];
      here = std::max(here, std::log(std::min(kMostRise, std::max(1.0, distance / tolerance))));
    }
    const auto neighbors = triangle_neighbors(triangles_);
    for (int pass = 0; pass < kRisePasses; ++pass) {
      auto spread = rise;
      for (std::size_t t = 0; t < rise.size(); ++t) {
        for (const int n : neighbors[t]) spread[t] = std::max(spread[t], 0.8 * rise[n]);
      }
      rise = std::move(spread);
    }
    for (std::size_t t = 0; t < rise.size(); ++t) weights_[t] = std::min(weights_[t] * std::exp(rise[t]), kMostWeight);
  }

  /// Moves vertices one by one until no angle is below `least`, radians, or none gets wider; nothing where so many
  /// triangles are narrow that this would take long.
  void widen(double least) {
    const auto few = static_cast<std::ptrdiff_t>(triangles_.size() / kNarrowOneIn);
    for (int pass = 0; pass < kWidenings; ++pass) {
      const auto narrow = std::count_if(triangles_.begin(), triangles_.end(),
                                        [&](const auto& corners) { return shortfall(corners, least) > 0; });
      if (narrow == 0 || narrow > few) return;
      bool any = false;
      for (const auto& patch : patches_.back()) {
        if (widen(patch, kWider * least)) any = true;
      }
      if (!any) return;
    }
  }

  [[nodiscard]] std::vector<BoundPoint> points() && { return std::move(points_); }

 private:
  /// Angles are widened to this many times the least wanted, in this many passes.
  static constexpr double kWider = 1.25;
  static constexpr int kWidenings = 40, kNarrowOneIn = 20;

  static constexpr double kMostRise = 1.5;
  static constexpr int kRisePasses = 6;

  /// How far the angles of a triangle are below `wanted`, squared and summed.
  [[nodiscard]] double shortfall(const std::array<int, 3>& corners, double wanted) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      const auto& tip = positions_[corners[c]];
      const Eigen::Vector3d u = positions_[corners[(c + 1) % 3]] - tip, v = positions_[corners[(c + 2) % 3]] - tip;
      sum += std::pow(std::max(0.0, wanted - std::atan2(u.cross(v).norm(), u.dot(v))), 2);
    }
    return sum;
  }

  /// The same of all triangles around a vertex; nothing where one is turned over.
  [[nodiscard]] std::optional<double> shortfall(const Patch& ring, double wanted) const {
    double sum = 0;
    for (const int t : ring.triangles) {
      if (!(signed_share(t) > 0)) return std::nullopt;
      sum += shortfall(triangles_[t], wanted);
    }
    return sum;
  }

  /// Tries places around a vertex of the finest level for one at which the angles around it are wider.
  bool widen(const Patch& ring, double wanted) {
    const int v = ring.center;
    const auto start = shortfall(ring, wanted);
    if (points_[v].curve.chain == CurvePoint::kCorner || !start || *start == 0) return false;
    const BoundPoint from = points_[v];
    BoundPoint best = from;
    double least = *start;
    const auto try_at = [&](const Eigen::Vector3d& displacement) {
      place(v, displaced(from, displacement));
      const auto reached = shortfall(ring, wanted);
      if (reached && *reached < least) {
        least = *reached;
        best = points_[v];
      }
    };
    const double edge = std::sqrt(ideal_area_ * 4 / std::sqrt(3.0));
    const Eigen::Vector3d normal = normals_[v];
    const Eigen::Vector3d t1 = is_free(v) ? normal.unitOrthogonal().eval() : curves_.tangent(from.curve);
    const Eigen::Vector3d t2 = normal.cross(t1);
    for (const double step : {0.4 * edge, 0.1 * edge, 0.025 * edge}) {
      constexpr int kDirections = 8;
      for (int k = 0; k < kDirections; ++k) {
        const double turn = 2 * std::numbers::pi * k / kDirections;
        try_at(step * (std::cos(turn) * t1 + std::sin(turn) * t2));
      }
    }
    place(v, best);
    return least < 0.999 * *start;
  }

  /// A triangle at a corner without a free vertex takes its normal from the free one beyond the edge that lies on no
  /// chain.
  void find_witnesses() {
    witness_.assign(triangles_.size(), -1);
    const auto neighbors = triangle_neighbors(triangles_);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto& corners = triangles_[t];
      if (std::any_of(corners.begin(), corners.end(), [&](int v) { return is_free(v); })) continue;
      for (int e = 0; e < 3; ++e) {
        const auto &a = points_[corners[e]].curve, &b = points_[corners[(e + 1) % 3]].curve;
        if (a.chain == CurvePoint::kCorner || b.chain == CurvePoint::kCorner) continue;
        const auto& beyond = triangles_[neighbors[t][e]];
        const auto found = std::find_if(beyond.begin(), beyond.end(), [&](int v) { return is_free(v); });
        if (found != beyond.end()) witness_[t] = *found;
      }
    }
  }

  /// Only free vertices have a normal: on a sharp line it would belong to neither side.
  void place(int v, const BoundPoint& at) {
    points_[v] = at;
    positions_[v] = surface_.position(at.point);
    normals_[v] = is_free(v) ? surface_.normal(at.point) : Eigen::Vector3d::Zero();
  }

  [[nodiscard]] bool is_free(int v) const { return points_[v].curve.chain == CurvePoint::kFree; }

  /// The corner of triangle t nearest to x among those that are to come nowhere yet; -1 if there is none.
  [[nodiscard]] int nearest_without_target(int t, const Eigen::Vector3d& x) const {
    int nearest = -1;
    for (const int v : triangles_[t]) {
      if (targets_[v] >= 0 || !is_free(v)) continue;
      if (nearest < 0 || (positions_[v] - x).squaredNorm() < (positions_[nearest] - x).squaredNorm()) nearest = v;
    }
    return nearest;
  }

  /// Area over ideal area, signed by the surface's normal.
  [[nodiscard]] double signed_share(int t) const {
    const auto& [a, b, c] = triangles_[t];
    const Eigen::Vector3d normal =
        witness_[t] >= 0 ? normals_[witness_[t]] : Eigen::Vector3d(normals_[a] + normals_[b] + normals_[c]);
    const double length = normal.norm();
    if (length < 1e-9) return 0;
    return (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]).dot(normal) /
           (2 * ideal_area_ * length);
  }

  [[nodiscard]] double energy(int t) const {
    const auto& [a, b, c] = triangles_[t];
    const double edges = (positions_[b] - positions_[a]).squaredNorm() + (positions_[c] - positions_[b]).squaredNorm() +
                         (positions_[a] - positions_[c]).squaredNorm();
    const double share = signed_share(t);
    const double positive = (share + std::sqrt(share * share + smoothing_ * smoothing_)) / 2;
    const double weighted = positive * weights_[t];
    const double conformal = edges / (4 * std::sqrt(3.0) * ideal_area_ * positive);
    return conformal * conformal * (weighted + 1 / weighted) / 2;
  }

  [[nodiscard]] double energy(const Patch& patch) const {
    double total = 0;
    for (const int t : patch.triangles) total += energy(t);
    for (const auto& member : patch.members) {
      const int target = targets_[member.vertex];
      if (target >= 0) total += pull_ * (positions_[member.vertex] - surface_.mesh().vertices[target]).squaredNorm();
    }
    for (const int v : patch.base) total += anchor_weight_ * base_planes_[v].at(positions_[v]);
    return total;
  }

  /// The smoothing of negative areas follows the worst triangle, so that the energy stays finite and downhill.
  void regularize() {
    double least = 1;
    for (std::size_t t = 0; t < triangles_.size(); ++t) least = std::min(least, signed_share(static_cast<int>(t)));
    smoothing_ = least > 0.02 ? 1e-3 : std::sqrt(1e-4 + 0.04 * least * least);
  }

  /// Moves the patch's center by (x, y) in its tangent plane and its members along by weight.
  void move(const Patch& patch, double reach) {
    const auto& curve = points_[patch.center].curve;
    if (curve.chain == CurvePoint::kCorner) return;
    if (curve.chain == CurvePoint::kFree) {
      set_steps_in_tangent_plane(patch);
    } else {
      set_steps_along(curves_.tangent(curve), patch);
    }
    const double start = energy(patch);
    const auto step = newton_step(patch, start, reach);
    if (step.squaredNorm() < 1e-16) return;
    for (double scale = 1; scale > 0.1; scale /= 2) {
      for (std::size_t m = 0; m < patch.members.size(); ++m) {
        const Eigen::Vector3d displacement = scale * (step.x() * steps_[m].along_1 + step.y() * steps_[m].along_2);
        place(patch.members[m].vertex, displaced(steps_[m].point, displacement));
      }
      if (energy(patch) < start) return;
    }
    for (std::size_t m = 0; m < patch.members.size(); ++m) place(patch.members[m].vertex, steps_[m].point);
  }

  void set_steps_in_tangent_plane(const Patch& patch) {
    const Eigen::Vector3d normal = normals_[patch.center];
    const Eigen::Vector3d t1 = normal.unitOrthogonal(), t2 = normal.cross(t1);
    steps_.clear();
    for (const auto& [vertex, weight] : patch.members) {
      const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(normal, normals_[vertex]);
      steps_.push_back({positions_[vertex], points_[vertex], weight * (turn * t1), weight * (turn * t2)});
    }
  }

  /// Members on the chain of the center go along it, free ones beside them.
  void set_steps_along(const Eigen::Vector3d& tangent, const Patch& patch) {
    steps_.clear();
    for (const auto& [vertex, weight] : patch.members) {
      Eigen::Vector3d along = tangent;
      if (is_free(vertex)) {
        along = (tangent - tangent.dot(normals_[vertex]) * normals_[vertex]).stableNormalized();
      } else {
        along = curves_.tangent(points_[vertex].curve);
        if (along.dot(tangent) < 0) along = -along;
      }
      steps_.push_back({positions_[vertex], points_[vertex], weight * along, Eigen::Vector3d::Zero()});
    }
  }

  [[nodiscard]] BoundPoint displaced(const BoundPoint& from, const Eigen::Vector3d& displacement) const {
    if (from.curve.chain == CurvePoint::kFree) return {surface_.walk(from.point, displacement), {}};
    const auto there = curves_.moved(from.curve, displacement.dot(curves_.tangent(from.curve)));
    return {curves_.point(there), there};
  }

  /// Newton step of the energy in the plane, by central differences; the Hessian made positive definite.
  [[nodiscard]] Eigen::Vector2d newton_step(const Patch& patch, double start, double reach) {
    const double h = 1e-3 * reach;
    const double east = shifted(patch, h, 0), west = shifted(patch, -h, 0);
    const double north = shifted(patch, 0, h), south = shifted(patch, 0, -h);
    const double north_east = shifted(patch, h, h);
    for (std::size_t m = 0; m < patch.members.size(); ++m) positions_[patch.members[m].vertex] = steps_[m].position;
    const Eigen::Vector2d gradient = Eigen::Vector2d(east - west, north - south) / (2 * h);
    const double xx = (east - 2 * start + west) / (h * h), yy = (north - 2 * start + south) / (h * h);
    const double xy = (north_east - east - north + start) / (h * h);
    Eigen::Matrix2d hessian;
    hessian << xx, xy, xy, yy;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes(hessian);
    const Eigen::Vector2d values = modes.eigenvalues().cwiseAbs();
    const double floor = 1e-3 * values.maxCoeff() + 1e-9 / (reach * reach);
    const Eigen::Vector2d in_modes = modes.eigenvectors().transpose() * gradient;
    Eigen::Vector2d step = -(modes.eigenvectors() * in_modes.cwiseQuotient(values.cwiseMax(floor)));
    const double length = step.norm();
    if (!(length < reach)) step *= length < 1e300 ? reach / length : 0.0;
    return step;
  }

  [[nodiscard]] double shifted(const Patch& patch, double x, double y) {
    for (std::size_t m = 0; m < patch.members.size(); ++m) {
      positions_[patch.members[m].vertex] = steps_[m].position + x * steps_[m].along_1 + y * steps_[m].along_2;
    }
    return energy(patch);
  }

  /// Where a member was before the move, and its share of a unit move along the two tangents.
  struct MemberStep {
    Eigen::Vector3d position;
    BoundPoint point;
    Eigen::Vector3d along_1, along_2;
  };

  const Surface& surface_;
  const FeatureCurves& curves_;
  std::vector<BoundPoint> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<std::vector<Patch>> patches_;  ///< of each level
  std::vector<Eigen::Vector3d> positions_, normals_;
  std::vector<MemberStep> steps_;
  const std::vector<Quadric>& base_planes_;
  double anchor_weight_ = 0;
  std::vector<double> weights_;  ///< of each triangle: how many times smaller than the mean it should be
  double ideal_area_ = 0;
  std::vector<int> targets_;  ///< of each vertex: the input's vertex that it should come to, or -1
  double pull_ = 0;           ///< per squared length
  double smoothing_ = 0;
  std::vector<int> witness_;  ///< of each triangle: the vertex whose normal stands for its own, or -1
};

}  // namespace

std::vector<BoundPoint> relax(const Surface& surface, const FeatureCurves& curves, const SemiRegularMesh& connectivity,
                              std::vector<BoundPoint> points, const std::vector<Quadric>& base_planes,
                              double least_angle, const std::function<void(double)>& progress) {
  Relaxation relaxation(surface, curves, connectivity, std::move(points), base_planes);
  for (int k = 0; k < kSweeps; ++k) {
    if (k >= kFirstLook && k < kSweeps - kFirstLook && k % kLookEvery == 0) {
      relaxation.refine_where_far(kTolerance);
      relaxation.aim_at_far(2 * kTolerance);
    }
    relaxation.sweep();
    progress((k + 1.0) / kSweeps);
  }
  relaxation.widen(least_angle);
  return std::move(relaxation).points();
}

}  // namespace greenloop::offline
