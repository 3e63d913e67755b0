#include "runtime/friction/contact_problem.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace greenloop {
namespace {

Float4 load(const Vec4& v) { return Float4{v.x, v.y, v.z, 0.0F}; }
Vec4 stored(Float4 v) { return {v[0], v[1], v[2], 0}; }
bool finite(Float4 v) { return dot3(v, v) <= FLT_MAX; }

}  // namespace

void ContactProblem::carve(Arena& arena, std::uint32_t candidates) noexcept {
  contact_ = arena.take<FrictionContact>(candidates);
  multiplier_ = arena.take<float>(candidates);
  gap_ = arena.take<Float4>(candidates);
  force_ = arena.take<Float4>(candidates);
  displacement_ = arena.take<Float4>(candidates);
  before_ = arena.take<Float4>(candidates);
  behind_ = arena.take<Float4>(candidates);
  best_force_ = arena.take<Float4>(candidates);
  best_displacement_ = arena.take<Float4>(candidates);
  newton_.carve(arena, candidates);
}

bool ContactProblem::set(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                         std::span<const Vec4> force) noexcept {
  points_ = {static_cast<std::uint32_t>(candidates.size()), contact_, gap_, compliance};
  bool valid = true;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    const ContactCandidate& candidate = candidates[i];
    valid &= set_friction_contact(load(candidate.normal), candidate.friction, compliance.at(i, i), contact_[i]);
    gap_[i] = load(candidate.gap);
    force_[i] = load(force[i]);
    multiplier_[i] = 0;
    valid &= finite(gap_[i]) && finite(force_[i]);
  }
  return valid;
}

void ContactProblem::sum_behind() noexcept {
  for (std::uint32_t j = 0; j < points_.count; ++j) {
    behind_[j] = Float4{};
    scatter(points_.compliance.column(j), force_[j], j, behind_);
  }
}

// forwards and backwards
void ContactProblem::sweep() noexcept {
  for (std::uint32_t j = 0; j < points_.count; ++j) {
    before_[j] = gathered(points_.compliance.column(j), force_, j);
    force_[j] = local_force(contact_[j], gap_[j] + (before_[j] + behind_[j]), multiplier_[j]);
    behind_[j] = Float4{};
  }
  for (std::uint32_t j = points_.count; j-- > 0;) {
    force_[j] = local_force(contact_[j], gap_[j] + (before_[j] + behind_[j]), multiplier_[j]);
    scatter(points_.compliance.column(j), force_[j], j, behind_);
  }
}

// displacements after a sweep; returns the relative residual
float ContactProblem::displace() noexcept {
  float of_force = 0;
  float of_residual = 0;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    before_[i] = gathered(points_.compliance.column(i), force_, i);
    displacement_[i] = gap_[i] + (before_[i] + behind_[i]) + product(points_.compliance.at(i, i), force_[i]);
    const Float4 residual = natural_map(contact_[i], displacement_[i], force_[i]);
    of_force += dot3(force_[i], force_[i]);
    of_residual += dot3(residual, residual);
  }
  return of_residual > 0 ? std::sqrt(of_residual / (of_force > of_residual ? of_force : of_residual)) : of_residual;
}

void ContactProblem::keep() noexcept {
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    best_force_[i] = force_[i];
    best_displacement_[i] = displacement_[i];
  }
}

// a Newton step if it and the next pair of sweeps fit; without one if it does not come out finite
bool ContactProblem::newton(std::uint64_t work, ContactAnswer& answer) noexcept {
  const std::uint64_t count = points_.count;
  const std::uint64_t needed = answer.work + newton_work(count, 0) + sweep_work(count);
  const std::uint64_t fitting = work > needed ? (work - needed) / vector_work(count) : 0;
  if (fitting == 0) {
    return false;
  }
  const auto most = static_cast<std::uint32_t>(std::min<std::uint64_t>(fitting, ContactNewton::most_vectors));
  answer.work += newton_work(count, newton_.step(points_, most, force_, displacement_)) + sweep_work(count);
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    if (!finite(force_[i])) force_[i] = best_force_[i];
  }
  sum_behind();
  return true;
}

ContactAnswer ContactProblem::solve(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                                    const ContactAccuracy& accuracy, std::uint64_t work, std::span<Vec4> force,
                                    std::span<ContactState> states, std::span<Vec4> displacements) noexcept {
  ContactAnswer answer;
  answer.valid = set(candidates, compliance, force);
  answer.work = least_work(points_.count);
  if (answer.valid) {
    answer.residual = FLT_MAX;
    sum_behind();
    do {
      sweep();
      ++answer.iterations;
      const float residual = displace();
      if (residual < answer.residual) {
        answer.residual = residual;
        keep();
      }
    } while (answer.residual > accuracy.residual && answer.iterations < accuracy.iterations && newton(work, answer));
    answer.valid = answer.residual < FLT_MAX;
  }
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    force[i] = answer.valid ? stored(best_force_[i]) : Vec4{};
    if (!states.empty()) states[i] = answer.valid ? contact_state(contact_[i], best_force_[i]) : ContactState::open;
    if (!displacements.empty()) displacements[i] = answer.valid ? stored(best_displacement_[i]) : Vec4{};
  }
  return answer;
}

}  // namespace greenloop
