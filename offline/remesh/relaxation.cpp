#include "offline/remesh/relaxation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace greenloop::offline {
namespace {

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
          const auto same = std::find_if(row.begin(), row.end(), [v = vertex](const Weighted& w) { return w.vertex == v; });
          if (same == row.end()) row.push_back({vertex, weight / 2});
          else same->weight += weight / 2;
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

class Relaxation {
 public:
  Relaxation(const Surface& surface, const SemiRegularMesh& mesh, std::vector<SurfacePoint> points, const std::vector<Quadric>& base_planes)
      : surface_(surface), points_(std::move(points)), triangles_(triangles_of_level(mesh, mesh.finest_level())), base_planes_(base_planes) {
    std::vector<std::vector<int>> around(points_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (const int v : triangles_[t]) around[v].push_back(static_cast<int>(t));
    }
    for (int level = 0; level <= mesh.finest_level(); ++level) patches_.push_back(hat_patches(mesh, level, around));
    positions_.resize(points_.size());
    normals_.resize(points_.size());
    for (std::size_t v = 0; v < points_.size(); ++v) place(static_cast<int>(v), points_[v]);
    double area = 0;
    const auto& input = surface.mesh();
    for (const auto& [a, b, c] : input.triangles) {
      area += (input.vertices[b] - input.vertices[a]).cross(input.vertices[c] - input.vertices[a]).norm() / 2;
    }
    anchor_weight_ = (getenv("AN")?atof(getenv("AN")):0.0) / area * (double)mesh.base_triangles.size() * std::ldexp(1.0,2*mesh.finest_level());
    ideal_area_ = area / static_cast<double>(triangles_.size());
  }

  /// One pass over all vertices of all levels; returns the energy reached.
  double sweep() {
    regularize();
    for (std::size_t level = 0; level < patches_.size(); ++level) {
      const double finer = std::ldexp(1.0, static_cast<int>(patches_.size() - 1 - level));
      const double reach = 0.5 * finer * std::sqrt(ideal_area_ * 4 / std::sqrt(3.0));
      for (const auto& patch : patches_[level]) move(patch, reach);
    }
    double total = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) total += energy(static_cast<int>(t));
    return total / static_cast<double>(triangles_.size());
  }

  [[nodiscard]] std::vector<SurfacePoint> points() && { return std::move(points_); }

 private:
  void place(int v, const SurfacePoint& point) {
    points_[v] = point;
    positions_[v] = surface_.position(point);
    normals_[v] = surface_.normal(point);
  }

  /// Area over ideal area, signed by the surface's normal.
  [[nodiscard]] double signed_share(int t) const {
    const auto& [a, b, c] = triangles_[t];
    const Eigen::Vector3d normal = normals_[a] + normals_[b] + normals_[c];
    const double length = normal.norm();
    if (length < 1e-9) return 0;
    return (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]).dot(normal) / (2 * ideal_area_ * length);
  }

  [[nodiscard]] double energy(int t) const {
    const auto& [a, b, c] = triangles_[t];
    const double edges = (positions_[b] - positions_[a]).squaredNorm() + (positions_[c] - positions_[b]).squaredNorm() +
                         (positions_[a] - positions_[c]).squaredNorm();
    const double share = signed_share(t);
    const double positive = (share + std::sqrt(share * share + smoothing_ * smoothing_)) / 2;
    const double conformal = edges / (4 * std::sqrt(3.0) * ideal_area_ * positive);
    static const auto env=[](const char*n,double d){return getenv(n)?atof(getenv(n)):d;};
    static const double kC=env("CP",2),kP=env("AP",1),kS=env("DS",0),kD=env("DP",2),kW=env("SG",0),kQ=env("SQ",2);
    double sag=0;
    if(kW>0){ for(const auto&[x,y]:{std::pair(a,b),std::pair(b,c),std::pair(c,a)}) sag+=std::pow((positions_[x]-positions_[y]).squaredNorm()*(normals_[x]-normals_[y]).squaredNorm()/(64*ideal_area_*2.3),kQ/2);}
    return std::pow(conformal,kC) * std::pow((positive + 1 / positive) / 2,kP)+kS*std::pow(positive,kD)+kW*sag;
  }

  [[nodiscard]] double energy(const Patch& patch) const {
    double total = 0;
    for (const int t : patch.triangles) total += energy(t);
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
    const Eigen::Vector3d normal = normals_[patch.center];
    const Eigen::Vector3d t1 = normal.unitOrthogonal(), t2 = normal.cross(t1);
    steps_.clear();
    for (const auto& [vertex, weight] : patch.members) {
      const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(normal, normals_[vertex]);
      steps_.push_back({positions_[vertex], points_[vertex], weight * (turn * t1), weight * (turn * t2)});
    }
    const double start = energy(patch);
    const auto step = newton_step(patch, start, reach);
    if (step.squaredNorm() < 1e-16) return;
    for (double scale = 1; scale > 0.1; scale /= 2) {
      for (std::size_t m = 0; m < patch.members.size(); ++m) {
        const Eigen::Vector3d displacement = scale * (step.x() * steps_[m].along_1 + step.y() * steps_[m].along_2);
        place(patch.members[m].vertex, surface_.walk(steps_[m].point, displacement));
      }
      if (energy(patch) < start) return;
    }
    for (std::size_t m = 0; m < patch.members.size(); ++m) place(patch.members[m].vertex, steps_[m].point);
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
    const double xy = (north_east - east - north + start) / (h * h) - 0.0;
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
    SurfacePoint point;
    Eigen::Vector3d along_1, along_2;
  };

  const Surface& surface_;
  std::vector<SurfacePoint> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<std::vector<Patch>> patches_;  ///< of each level
  std::vector<Eigen::Vector3d> positions_, normals_;
  std::vector<MemberStep> steps_;
  const std::vector<Quadric>& base_planes_; double anchor_weight_=0;
  double ideal_area_ = 0;
  double smoothing_ = 0;
};

}  // namespace

std::vector<SurfacePoint> relax(const Surface& surface, const SemiRegularMesh& connectivity,
                                std::vector<SurfacePoint> points, const std::vector<Quadric>& base_planes,
                                const std::function<void(double)>& progress) {
  const int kSweeps = getenv("SW")?atoi(getenv("SW")):60;
  Relaxation relaxation(surface, connectivity, std::move(points), base_planes);
  for (int k = 0; k < kSweeps; ++k) {
    const double energy = relaxation.sweep();
    if (getenv("GL_DEBUG")) fprintf(stderr, "sweep %d energy %.6g\n", k, energy);
    progress((k + 1.0) / kSweeps);
  }
  return std::move(relaxation).points();
}

}  // namespace greenloop::offline
