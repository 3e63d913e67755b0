#include "runtime/contact/contact_problem.hpp"

#include <cfloat>
#include <cmath>

namespace greenloop {
namespace {

Float4 load(const Vec4& v) { return Float4{v.x, v.y, v.z, 0.0F}; }
Vec4 stored(Float4 v) { return {v[0], v[1], v[2], 0}; }

// the displacement of a column's candidate by the forces of `count` candidates before it
Float4 gathered(const Block<3>* column, const Float4* force, std::uint32_t count) {
  Float4 even[3] = {};
  Float4 odd[3] = {};
  std::uint32_t i = 0;
  for (; i + 2 <= count; i += 2) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      even[k] += column[i].column[k] * force[i];
      odd[k] += column[i + 1].column[k] * force[i + 1];
    }
  }
  if (i < count) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      even[k] += column[i].column[k] * force[i];
    }
  }
  const Block<3> rows = transposed(Block<3>{{even[0] + odd[0], even[1] + odd[1], even[2] + odd[2]}});
  return (rows.column[0] + rows.column[1]) + rows.column[2];
}

// adds the displacements of `count` candidates before a column's by its force
void scatter(const Block<3>* column, Float4 force, std::uint32_t count, Float4* displacement) {
  if (force[0] == 0 && force[1] == 0 && force[2] == 0) {
    return;
  }
  const Splats<3> of_all = splats(force);
  for (std::uint32_t i = 0; i < count; ++i) {
    displacement[i] += product(column[i], of_all);
  }
}

bool finite(Float4 v) { return dot3(v, v) <= FLT_MAX; }

}  // namespace

void ContactProblem::carve(Arena& arena, std::uint32_t candidates) noexcept {
  contact_ = arena.take<FrictionContact>(candidates);
  multiplier_ = arena.take<float>(candidates);
  gap_ = arena.take<Float4>(candidates);
  force_ = arena.take<Float4>(candidates);
  begun_ = arena.take<Float4>(candidates);
  before_ = arena.take<Float4>(candidates);
  behind_ = arena.take<Float4>(candidates);
  displacement_ = arena.take<Float4>(candidates);
  mixing_.carve(arena, candidates);
}

bool ContactProblem::set(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                         std::span<const Vec4> force) noexcept {
  count_ = static_cast<std::uint32_t>(candidates.size());
  bool valid = true;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const ContactCandidate& candidate = candidates[i];
    valid = set_friction_contact(load(candidate.normal), candidate.friction, compliance.at(i, i), contact_[i]) && valid;
    gap_[i] = load(candidate.gap);
    begun_[i] = cone_projection(contact_[i], load(force[i]));
    valid = valid && finite(gap_[i]) && finite(begun_[i]);
    force_[i] = begun_[i];
    multiplier_[i] = 0;
  }
  return valid;
}

void ContactProblem::sum_behind(const ContactCompliance& compliance) noexcept {
  for (std::uint32_t j = 0; j < count_; ++j) {
    behind_[j] = Float4{};
    scatter(compliance.column(j), force_[j], j, behind_);
  }
}

void ContactProblem::sweep_forwards(const ContactCompliance& compliance) noexcept {
  for (std::uint32_t j = 0; j < count_; ++j) {
    before_[j] = gathered(compliance.column(j), force_, j);
    force_[j] = local_force(contact_[j], gap_[j] + (before_[j] + behind_[j]), multiplier_[j]);
  }
}

void ContactProblem::sweep_backwards(const ContactCompliance& compliance) noexcept {
  for (std::uint32_t j = 0; j < count_; ++j) {
    behind_[j] = Float4{};
  }
  for (std::uint32_t j = count_; j-- > 0;) {
    force_[j] = local_force(contact_[j], gap_[j] + (before_[j] + behind_[j]), multiplier_[j]);
    scatter(compliance.column(j), force_[j], j, behind_);
  }
}

ContactProblem::Sizes ContactProblem::step() const noexcept {
  Sizes sum;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Float4 change = force_[i] - begun_[i];
    sum.force += dot3(force_[i], force_[i]);
    sum.residual += dot3(change, change);
  }
  return {std::sqrt(sum.force), std::sqrt(sum.residual)};
}

// the displacements by the forces as they are
ContactProblem::Sizes ContactProblem::displace(const ContactCompliance& compliance) noexcept {
  Sizes sum;
  for (std::uint32_t i = 0; i < count_; ++i) {
    before_[i] = gathered(compliance.column(i), force_, i);
    displacement_[i] = gap_[i] + (before_[i] + behind_[i]) + product(compliance.at(i, i), force_[i]);
    const Float4 residual = natural_map(contact_[i], displacement_[i], force_[i]);
    sum.force += dot3(force_[i], force_[i]);
    sum.residual += dot3(residual, residual);
  }
  return {std::sqrt(sum.force), std::sqrt(sum.residual)};
}

// candidates without a force stay so
void ContactProblem::extrapolate() noexcept {
  mixing_.mix(force_, begun_);
  for (std::uint32_t i = 0; i < count_; ++i) {
    const bool open = force_[i][0] == 0 && force_[i][1] == 0 && force_[i][2] == 0;
    (void)open;
    force_[i] = begun_[i];
  }
}

ContactAnswer ContactProblem::solve(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                                    const ContactAccuracy& accuracy, std::uint64_t work, std::span<Vec4> force,
                                    std::span<ContactState> states, std::span<Vec4> displacements) noexcept {
  ContactAnswer answer;
  answer.valid = set(candidates, compliance, force);
  answer.work = setup_work(count_);
  if (answer.valid) {
    sum_behind(compliance);
    mixing_.begin(count_);
    Sizes sizes;
    while (true) {
      sweep_forwards(compliance);
      sweep_backwards(compliance);
      ++answer.iterations;
      answer.work += iteration_work(count_);
      const bool last = answer.work + iteration_work(count_) > work || answer.iterations >= accuracy.iterations;
      sizes = step();
      if (last || sizes.residual <= 2 * accuracy.residual * sizes.force) {
        sizes = displace(compliance);
        if (last || sizes.residual <= accuracy.residual * sizes.force) break;
      }
      extrapolate();
      sum_behind(compliance);
    }
    answer.residual = sizes.residual > 0 ? sizes.residual / std::fmax(sizes.force, sizes.residual) : 0;
    answer.valid = sizes.force <= FLT_MAX && sizes.residual <= FLT_MAX;
  }
  for (std::uint32_t i = 0; i < count_; ++i) {
    force[i] = answer.valid ? stored(force_[i]) : Vec4{};
    if (!states.empty()) states[i] = answer.valid ? contact_state(contact_[i], force_[i]) : ContactState::open;
    if (!displacements.empty()) displacements[i] = answer.valid ? stored(displacement_[i]) : Vec4{};
  }
  return answer;
}

}  // namespace greenloop
