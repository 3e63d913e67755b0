#include "runtime/friction/contact_problem.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace greenloop {
namespace {

// of ContactNewton::step, in turn: what one runs in circles with, another may solve
constexpr float weights[4] = {3, 10, 30, 1};

Float4 load(const Vec4& v) { return Float4{v.x, v.y, v.z, 0.0F}; }
Vec4 stored(Float4 v) { return {v[0], v[1], v[2], 0}; }
bool finite(Float4 v) { return dot3(v, v) <= FLT_MAX; }

}  // namespace

void ContactProblem::carve(Arena& arena, std::uint32_t candidates, const Prices& prices) noexcept {
  prices_ = prices;
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

// forwards and backwards; then the displacements
void ContactProblem::sweep() noexcept {
  const ContactCompliance& compliance = points_.compliance;
  for (std::uint32_t j = 0; j < points_.count; ++j) {
    behind_[j] = Float4{};
    scatter(compliance.column(j), force_[j], j, behind_);
  }
  PushedPoints forwards;
  for (std::uint32_t j = 0; j < points_.count; ++j) {
    before_[j] = forwards.gathered(compliance.column(j), force_);
    force_[j] = local_force(contact_[j], gap_[j] + (before_[j] + behind_[j]), multiplier_[j]);
    forwards.add(j, force_[j]);
    behind_[j] = Float4{};
  }
  for (std::uint32_t j = points_.count; j-- > 0;) {
    force_[j] = local_force(contact_[j], gap_[j] + (before_[j] + behind_[j]), multiplier_[j]);
    scatter(compliance.column(j), force_[j], j, behind_);
  }
  PushedPoints at_last;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    const Float4 before = at_last.gathered(compliance.column(i), force_);
    at_last.add(i, force_[i]);
    displacement_[i] = gap_[i] + (before + behind_[i]) + product(compliance.at(i, i), force_[i]);
  }
}

void ContactProblem::project() noexcept {
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    force_[i] = force_in_cone(contact_[i], finite(force_[i]) ? force_[i] : best_force_[i]);
  }
  displace(points_, force_, displacement_);
}

// of the iterate
ContactProblem::Residual ContactProblem::residual() const noexcept {
  Residual residual;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    const Float4 map = natural_map(contact_[i], displacement_[i], force_[i]);
    residual.of_force += dot3(force_[i], force_[i]);
    residual.square += dot3(map, map);
  }
  return residual;
}

float ContactProblem::Residual::relative() const noexcept {
  return square == 0 ? 0 : std::sqrt(square / (of_force > square ? of_force : square));
}

// keeps the iterate if it is better: in newtons, since far from a solution large forces make any residual look small
void ContactProblem::judge(ContactAnswer& answer) noexcept {
  const Residual here = residual();
  if (here.square < best_square_) {
    best_square_ = here.square;
    answer.residual = here.relative();
    for (std::uint32_t i = 0; i < points_.count; ++i) {
      best_force_[i] = force_[i];
      best_displacement_[i] = displacement_[i];
    }
  }
}

// at least two steps, of which the first may lead away, then more while each takes a third of the residual; false if
// there is no room for one
bool ContactProblem::newton(float accuracy, std::uint64_t work, ContactAnswer& answer) noexcept {
  const std::uint64_t count = points_.count;
  ContactNewton::Terms terms{.weight = weights[(answer.iterations - 1) % 4], .reduction = 0, .vectors = 0};
  float last = FLT_MAX;
  std::uint32_t steps = 0;
  for (float here = residual().relative(); here < last * (2.0F / 3) && steps < most_steps;
       here = residual().relative()) {
    const std::uint64_t needed = answer.work + newton_work(prices_, count, 0) + projection_work(prices_, count);
    const std::uint64_t vectors = work > needed ? (work - needed) / vector_work(prices_, count) : 0;
    if (vectors == 0 || (steps > 0 && here <= 0.9F * accuracy)) break;
    last = steps++ == 0 ? FLT_MAX : here;
    terms.reduction = std::min(std::max(0.1F * accuracy / here, 0.01F), 0.1F);
    terms.vectors = static_cast<std::uint32_t>(std::min<std::uint64_t>(vectors, ContactNewton::most_vectors));
    answer.work += newton_work(prices_, count, newton_.step(points_, terms, force_, displacement_));
  }
  if (steps == 0) {
    return false;
  }
  project();
  answer.work += projection_work(prices_, count);
  judge(answer);
  return true;
}

void ContactProblem::iterate(const ContactAccuracy& accuracy, std::uint64_t work, ContactAnswer& answer) noexcept {
  answer.residual = best_square_ = FLT_MAX;
  do {
    sweep();
    judge(answer);
    ++answer.iterations;
    answer.work += sweep_work(prices_, points_.count);
  } while (answer.residual > accuracy.residual && answer.iterations < accuracy.iterations &&
           newton(accuracy.residual, work, answer) && answer.residual > accuracy.residual &&
           answer.work + sweep_work(prices_, points_.count) <= work);
}

// The work of forces on the way that they give is at most that on the gaps they close, with friction too, once the laws
// hold. Forces that do more are drawn back to the least energy between none and themselves: they still push and lie in
// their cones.
void ContactProblem::bound_energy(ContactAnswer& answer) noexcept {
  float closed = 0;
  float given = 0;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    closed -= dot3(best_force_[i], gap_[i]);
    given += dot3(best_force_[i], best_displacement_[i] - gap_[i]);
  }
  if (!(given > closed)) {
    return;
  }
  const float share = closed > 0 ? closed / given : 0;
  for (std::uint32_t i = 0; i < points_.count; ++i) {
    force_[i] = best_force_[i] * share;
    displacement_[i] = gap_[i] + (best_displacement_[i] - gap_[i]) * share;
  }
  answer.residual = best_square_ = FLT_MAX;
  judge(answer);
}

std::uint64_t ContactProblem::respond(Float4* displacement, Float4* force) noexcept {
  const ContactNewton::Terms terms{.weight = 1, .reduction = 1e-3F, .vectors = ContactNewton::most_vectors};
  return newton_work(prices_, points_.count, newton_.respond(points_, terms, displacement, force));
}

ContactAnswer ContactProblem::solve(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                                    const ContactAccuracy& accuracy, std::uint64_t work, std::span<Vec4> force,
                                    std::span<ContactState> states, std::span<Vec4> displacements) noexcept {
  ContactAnswer answer;
  answer.work = setup_work(prices_, candidates.size());
  answer.valid = set(candidates, compliance, force);
  if (answer.valid) {
    iterate(accuracy, work, answer);
    if (answer.residual > accuracy.residual) bound_energy(answer);
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
