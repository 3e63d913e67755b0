#include "offline/simulate/thin_sheets.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr double gravity = 9.81;
constexpr double settling_damping = 4;  // 1/s
constexpr int substeps_per_search = 2;
constexpr double torn = 2;  // of the length as sewn: what flies apart is no cloth

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("sheets: ") + what);
}

SheetScene valid(SheetScene scene) {
  require(!scene.mesh.triangles.empty(), "triangles are needed");
  require(scene.fixed.size() == scene.mesh.vertices.size(), "one mark of what is fixed for each vertex is needed");
  require(scene.time_step > 0 && scene.substeps >= 1, "time step and substeps must be positive");
  require(scene.thickness > 0, "the thickness must be positive");
  require(scene.density > 0 && scene.stretch > 0 && scene.bend > 0, "density and stiffness must be positive");
  require(scene.damping >= 0 && scene.air >= 0, "damping must not be negative");
  return scene;
}

std::vector<double> masses_of(const SheetScene& scene) {
  auto masses = lumped_masses(scene.mesh, scene.density);
  for (std::size_t v = 0; v < masses.size(); ++v) {
    if (scene.fixed[v] != 0) masses[v] = 0;
  }
  return masses;
}

}  // namespace

ThinSheets::ThinSheets(SheetScene scene)
    : scene_(valid(std::move(scene))),
      shown_(loop_subdivision(scene_.mesh, scene_.finer)),
      elasticity_(scene_.mesh, scene_.stretch, scene_.bend, masses_of(scene_)),
      contacts_(scene_.mesh, scene_.thickness, scene_.friction, masses_of(scene_)),
      x_(scene_.mesh.vertices),
      v_(x_.size(), Vector3d::Zero()) {
  for (const auto& t : shown_.triangles) triangles_.insert(triangles_.end(), t.begin(), t.end());
  const auto frames = std::lround(scene_.settling / scene_.time_step);
  for (long i = 0; i < frames; ++i) pass(settling_damping);
  v_.assign(x_.size(), Vector3d::Zero());
  rest_ = state();
}

void ThinSheets::apply(std::size_t impulse) {
  const SupportMotion& next = scene_.impulses.at(impulse);
  const Vector3d jump = next.velocity - motion_.velocity, spin(0, next.turning - motion_.turning, 0);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (scene_.fixed[i] == 0) v_[i] -= jump + spin.cross(x_[i]);
  }
  motion_ = next;
}

Places ThinSheets::normals() const {
  Places normals(x_.size(), Vector3d::Zero());
  for (const auto& t : scene_.mesh.triangles) {
    const Vector3d normal = (x_[t[1]] - x_[t[0]]).cross(x_[t[2]] - x_[t[0]]);
    for (const int corner : t) normals[corner] += normal;
  }
  for (auto& normal : normals) normal.normalize();
  return normals;
}

void ThinSheets::pass(double damping) {
  const double time_step = scene_.time_step / scene_.substeps;
  for (int i = 0; i < scene_.substeps; ++i) {
    if (i % substeps_per_search == 0) contacts_.find(x_);
    pass_substep(damping, time_step);
  }
  const double stretch = elasticity_.largest_stretch(x_);
  if (stretch > torn) {
    throw std::runtime_error("sheets: an edge is " + std::to_string(stretch) + " times as long as sewn with " +
                             std::to_string(scene_.substeps) +
                             " substeps, each too long for what is as stiff: raise sheet.substeps");
  }
}

/// Forces act on velocities, constraints on places.
void ThinSheets::pass_substep(double damping, double time_step) {
  const Vector3d spin(0, motion_.turning, 0), down(0, -gravity, 0);
  const double kept = std::exp(-damping * time_step), caught = -std::expm1(-scene_.air * time_step);
  const Places normal = scene_.air > 0 ? normals() : Places();
  const Places before = x_;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (scene_.fixed[i] != 0) continue;
    const Vector3d swept = spin.cross(x_[i]);
    if (scene_.air > 0) v_[i] -= caught * (v_[i] + motion_.velocity + swept).dot(normal[i]) * normal[i];
    v_[i] += time_step * (down - spin.cross(2 * v_[i] + swept));
    v_[i] *= kept;
    x_[i] += time_step * v_[i];
  }
  elasticity_.relax(time_step, x_);
  contacts_.relax(time_step, before, x_);
  keep_outside(time_step, before);
  for (std::size_t i = 0; i < x_.size(); ++i) v_[i] = (x_[i] - before[i]) / time_step;
}

/// Moves what has come nearer to rigid shapes than the thickness out of them; friction holds back what moved along.
void ThinSheets::keep_outside(double time_step, const Places& before) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (scene_.fixed[i] != 0) continue;
    for (const RigidShape& shape : scene_.rigid) {
      const Clearance free = clearance(shape, x_[i]);
      if (free.distance >= scene_.thickness) continue;
      const double was = std::max(0.0, clearance(shape, before[i]).distance);
      const double missing = std::min(scene_.thickness, was + parting_speed * time_step) - free.distance;
      if (missing <= 0) continue;
      Vector3d slid = x_[i] - before[i];
      slid -= slid.dot(free.normal) * free.normal;
      const double length = slid.norm(), held = scene_.friction * missing;
      x_[i] += missing * free.normal - (length > held ? held / length : 1.0) * slid;
    }
  }
}

void ThinSheets::positions(std::span<float> out) const {
  require(out.size() == 3 * vertices(), "positions need three numbers a vertex");
  Eigen::MatrixX3d places(static_cast<Eigen::Index>(x_.size()), 3);
  for (std::size_t v = 0; v < x_.size(); ++v) places.row(static_cast<Eigen::Index>(v)) = x_[v];
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Eigen::Map<Rows>(out.data(), shown_.weights.rows(), 3) = (shown_.weights * places).cast<float>();
}

bool ThinSheets::at_rest() const {
  const bool swept = motion_.turning != 0 || (scene_.air > 0 && !motion_.velocity.isZero());
  if (swept) return false;
  for (std::size_t v = 0; v < x_.size(); ++v) {
    const Vector3d rest(rest_[6 * v], rest_[6 * v + 1], rest_[6 * v + 2]);
    if ((x_[v] - rest).norm() > scene_.rest || v_[v].norm() > scene_.rest) return false;
  }
  return true;
}

std::vector<double> ThinSheets::state() const {
  std::vector<double> all;
  all.reserve(6 * x_.size() + 4);
  for (std::size_t v = 0; v < x_.size(); ++v) {
    all.insert(all.end(), {x_[v].x(), x_[v].y(), x_[v].z(), v_[v].x(), v_[v].y(), v_[v].z()});
  }
  for (const double part : motion_.velocity) all.push_back(part);
  all.push_back(motion_.turning);
  return all;
}

void ThinSheets::restore(std::span<const double> state) {
  const std::size_t numbers = 6 * x_.size() + 4;
  if (state.size() != numbers) {
    throw std::invalid_argument("sheets: a state of " + std::to_string(state.size()) + " numbers instead of " +
                                std::to_string(numbers));
  }
  for (std::size_t v = 0; v < x_.size(); ++v) {
    const auto place = state.subspan(6 * v, 6);
    x_[v] = {place[0], place[1], place[2]};
    v_[v] = {place[3], place[4], place[5]};
  }
  const auto motion = state.last(4);
  motion_ = {{motion[0], motion[1], motion[2]}, motion[3]};
}

}  // namespace greenloop::offline
