#include "offline/simulate/elastic_solid.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "offline/simulate/embedding.hpp"

namespace greenloop::offline {
namespace {

SolidProblem problem_of(const ElasticSolidScene& scene) {
  return {scene.mesh,      scene.fixed,  scene.material, scene.density, scene.mass_damping, scene.stiffness_damping,
          scene.time_step, scene.strain, scene.newmark};
}

/// The columns of the free vertices.
Interpolation from_free(const Interpolation& from_all, const FreeVertices& free) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < from_all.outerSize(); ++row) {
    for (Interpolation::InnerIterator it(from_all, row); it; ++it) {
      const int column = free.number[it.col()];
      if (column >= 0) entries.emplace_back(row, column, it.value());
    }
  }
  Interpolation result(from_all.rows(), free.count);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

double largest_of_vertices(const Eigen::VectorXd& vectors) {
  return vectors.reshaped(3, vectors.size() / 3).colwise().norm().maxCoeff();
}

}  // namespace

ElasticSolid::ElasticSolid(ElasticSolidScene scene)
    : scene_(std::move(scene)),
      dynamics_(problem_of(scene_)),
      lowest_frequency_(dynamics_.lowest_frequency()),
      binding_(from_free(embed(scene_.shown, scene_.mesh), dynamics_.free())),
      state_(dynamics_.rest()) {
  for (const auto& velocity : scene_.velocities) jumps_.push_back(dynamics_.velocity_jump(velocity));
}

void ElasticSolid::reset() { state_ = dynamics_.rest(); }

void ElasticSolid::apply(std::size_t impulse) {
  state_.v += jumps_.at(impulse);
  dynamics_.balance(state_);
}

void ElasticSolid::step() { dynamics_.step(state_); }

void ElasticSolid::positions(std::span<float> out) const {
  if (out.size() != 3 * vertices()) throw std::invalid_argument("simulation: positions need three numbers a vertex");
  for (int shown = 0; shown < binding_.outerSize(); ++shown) {
    Eigen::Vector3d position = scene_.shown[shown];
    for (Interpolation::InnerIterator it(binding_, shown); it; ++it) {
      position += it.value() * state_.u.segment<3>(3 * it.col());
    }
    for (int i = 0; i < 3; ++i) out[3 * shown + i] = static_cast<float>(position[i]);
  }
}

bool ElasticSolid::at_rest() const {
  return largest_of_vertices(state_.u) <= scene_.rest &&
         largest_of_vertices(state_.v) <= scene_.rest * lowest_frequency_;
}

std::vector<double> ElasticSolid::state() const {
  std::vector<double> all;
  for (const auto* part : {&state_.u, &state_.v, &state_.a}) all.insert(all.end(), part->begin(), part->end());
  return all;
}

void ElasticSolid::restore(std::span<const double> state) {
  const auto size = static_cast<std::size_t>(state_.u.size());
  if (state.size() != 3 * size) {
    throw std::invalid_argument("simulation: a state of " + std::to_string(state.size()) + " numbers instead of " +
                                std::to_string(3 * size));
  }
  for (auto* part : {&state_.u, &state_.v, &state_.a}) {
    *part = Eigen::Map<const Eigen::VectorXd>(state.data(), state_.u.size());
    state = state.subspan(size);
  }
}

}  // namespace greenloop::offline
