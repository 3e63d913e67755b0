#include "runtime/multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "runtime/memory/fit.hpp"
#include "runtime/multigrid/answers.hpp"
#include "runtime/multigrid/elastic_body.hpp"
#include "runtime/multigrid/newton.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t most_inputs = 65536;
constexpr double least_fall = 0.8;  // of a pass, of the square of the residual, for another to follow
constexpr double forcing = 0.1;     // of a pass's residual, to which conjugate gradients reduce it before the next pass

bool is_elastic(const Model& model) { return model.problem() == layout::Problem::multigrid; }

bool in_range(const Multigrid::Limits& limits) {
  return limits.max_loads <= most_inputs && limits.max_holds <= most_inputs && limits.tolerance >= 1.0e-6F &&
         limits.tolerance <= 0.5F;
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Float4 float4(const Vec3& v) { return Float4{v.x, v.y, v.z, 0.0F}; }

/// A status and the input that it is about.
struct Refusal {
  Status status = Status::ok;
  std::uint32_t input = StepReport::no_constraint;
};

Refusal check_loads(const ElasticBody& body, std::span<const Multigrid::Load> loads) {
  if (loads.size() > body.max_loads) return {Status::held_out_of_range, body.max_loads};
  for (std::uint32_t i = 0; i < loads.size(); ++i) {
    if (loads[i].vertex >= body.vertices()) return {Status::held_out_of_range, i};
    if (!is_finite(loads[i].force)) return {Status::held_not_finite, i};
  }
  return {};
}

/// Marks the vertices of `holds` as held, as far as they may be.
Refusal mark_holds(ElasticBody& body, std::span<const Multigrid::Hold> holds) {
  for (std::uint32_t i = 0; i < body.holds; ++i) body.moves[body.held[i]] = 1;
  body.holds = 0;
  if (holds.size() > body.max_holds) return {Status::held_out_of_range, body.max_holds};
  for (std::uint32_t i = 0; i < holds.size(); ++i) {
    const Multigrid::Hold& hold = holds[i];
    if (hold.vertex >= body.vertices()) return {Status::held_out_of_range, i};
    if (!is_finite(hold.displacement)) return {Status::held_not_finite, i};
    if (hold.vertex >= body.free()) return {Status::held_not_touchable, i};
    if (body.moves[hold.vertex] == 0) return {Status::held_duplicate, i};
    body.moves[hold.vertex] = 0;
    body.held[body.holds++] = hold.vertex;
  }
  return {};
}

Status check_response(const ElasticBody& body, const Multigrid::Inputs& inputs, const Multigrid::Response& response) {
  const auto fits = [](std::size_t size, std::size_t expected) { return size == 0 || size == expected; };
  const std::size_t displaced = response.chosen.empty() ? body.vertices() : response.chosen.size();
  if (!fits(response.displacement.size(), displaced) || !fits(response.reaction.size(), inputs.holds.size()) ||
      !fits(response.shown.size(), body.view.info->shown) || !fits(response.stress.size(), body.vertices())) {
    return Status::held_response_size;
  }
  for (const std::uint32_t vertex : response.chosen) {
    if (vertex >= body.vertices()) return Status::held_out_of_range;
  }
  return Status::ok;
}

std::uint64_t answer_work(const ElasticBody& body, const Multigrid::Inputs& inputs,
                          const Multigrid::Response& response) {
  return state_work(body.view, static_cast<std::uint32_t>(inputs.loads.size()),
                    static_cast<std::uint32_t>(inputs.holds.size())) +
         (response.shown.empty() ? 0 : shown_work(body.view)) + (response.stress.empty() ? 0 : stress_work(body.view));
}

/// The state that would be without any acceleration in this step, and holds where they are.
void predict(ElasticBody& body, std::span<const Multigrid::Hold> holds) {
  const Newmark& newmark = body.newmark;
  const float dt = newmark.time_step;
  const Float4 step = splat(dt), half = splat(dt * dt * (0.5F - newmark.beta)), rate = splat(dt * (1 - newmark.gamma));
  for (std::uint32_t v = 0; v < body.free(); ++v) {
    const Float4 velocity = body.state.velocity[v], acceleration = body.state.acceleration[v];
    body.next.displacement[v] = (body.state.displacement[v] + step * velocity) + half * acceleration;
    body.next.velocity[v] = velocity + rate * acceleration;
    body.next.acceleration[v] = Float4{};
  }
  // backward differences: Newmark's own would let the velocity of a vertex that is led swing from step to step
  const Float4 per_step = splat(1 / dt);
  for (const Multigrid::Hold& hold : holds) {
    const std::uint32_t v = hold.vertex;
    const Float4 target = float4(hold.displacement);
    body.next.velocity[v] = per_step * (target - body.state.displacement[v]);
    body.next.acceleration[v] = per_step * (body.next.velocity[v] - body.state.velocity[v]);
    body.next.displacement[v] = target;
  }
}

/// Sets external forces; returns the sum of squares of them and of what each vertex weighs, N^2. What acts on a vertex
/// that the model holds goes into its support.
double set_loads(ElasticBody& body, const Multigrid::Inputs& inputs) {
  for (Float4& force : body.force) force = Float4{};
  for (const Multigrid::Load& load : inputs.loads) {
    if (load.vertex < body.free()) body.force[load.vertex] += float4(load.force);
  }
  const float* const own = body.view.info->gravity;
  body.gravity = inputs.gravity != nullptr ? float4(*inputs.gravity) : Float4{own[0], own[1], own[2], 0.0F};
  double sum = 0;
  for (std::uint32_t v = 0; v < body.free(); ++v) {
    const Float4 force = body.force[v] + splat(body.vertex_mass[v]) * body.gravity, square = force * force;
    sum += static_cast<double>((square[0] + square[1]) + square[2]);
  }
  return sum;
}

/// Whether the state that was found is finite and near the one before.
bool is_sound(const ElasticBody& body) {
  const float most = 2 * body.view.info->size;
  float farthest = 0;
  for (std::uint32_t v = 0; v < body.free(); ++v) {
    const Float4 moved = body.next.displacement[v] - body.state.displacement[v], square = moved * moved;
    const float sum = (square[0] + square[1]) + square[2];
    if (!(sum <= most * most)) return false;
    farthest = sum > farthest ? sum : farthest;
  }
  return std::isfinite(farthest);
}

void keep_frames(ElasticBody& body) {
  if (body.measure != StrainMeasure::corotational) return;
  for (std::size_t g = 0; g < body.groups.size(); ++g) body.last_quaternion[g] = body.quaternion[g];
}

/// Back to the last state, at rest, whose frames are not those that were tried.
void stop(ElasticBody& body) {
  for (Float4& v : body.state.velocity) v = Float4{};
  for (Float4& a : body.state.acceleration) a = Float4{};
  if (body.measure == StrainMeasure::green) {
    find_frames(body.measure, body.groups, body.state.displacement.data(), body.quaternion, body.frame);
  }
  if (body.measure != StrainMeasure::corotational) return;
  for (std::size_t g = 0; g < body.groups.size(); ++g) {
    body.quaternion[g] = body.last_quaternion[g];
    body.frame[g] = matrix_of(body.quaternion[g]);
  }
}

void take_over(ElasticBody& body) {
  for (std::uint32_t v = 0; v < body.free(); ++v) {
    body.state.displacement[v] = body.next.displacement[v];
    body.state.velocity[v] = body.next.velocity[v];
    body.state.acceleration[v] = body.next.acceleration[v];
  }
}

struct Balance {
  double residual = 0;  ///< relative
  std::uint32_t cycles = 0, passes = 0;
  std::uint64_t work = 0;
};

/// Not finite where one of the two is not. squares: of forces, N^2.
double relative_residual(double square, double largest_square) {
  if (!std::isfinite(largest_square) || !std::isfinite(square)) return std::numeric_limits<double>::infinity();
  return largest_square > 0 ? std::sqrt(square / largest_square) : 0;
}

/// Of a pass with one cycle, along the last acceleration first, and of the residual behind it.
std::uint64_t least_balance_work(const MultigridView& view) {
  return 2 * residual_work(view) + pass_work(view) + product_work(view) + iteration_work(view);
}

/// Newton passes within `work`, of which what the last residual takes is always left.
Balance balance(ElasticBody& body, double loads, float tolerance, std::uint64_t work) {
  const std::uint64_t residual = residual_work(body.view), iteration = iteration_work(body.view);
  const double relative = static_cast<double>(tolerance) * static_cast<double>(tolerance);
  Balance balance;
  double first = 0, before = std::numeric_limits<double>::infinity();
  for (;;) {
    const Imbalance now = find_residual(body);
    balance.work += residual;
    if (balance.passes == 0) first = now.moving;
    const double largest = std::max(first, std::max(loads, now.held));
    const double goal = relative * largest;
    balance.residual = relative_residual(now.moving, largest);
    const bool first_pass = balance.passes == 0;
    const std::uint64_t start = pass_work(body.view) + (first_pass ? product_work(body.view) : 0);
    const bool fits = balance.work + start + iteration + residual <= work;
    // rounding leaves a rest that no pass lessens
    const bool falls = now.moving < least_fall * before;
    if (!(now.moving > goal) || !fits || !falls) return balance;
    before = now.moving;
    const double enough = std::max(0.5 * goal, forcing * forcing * now.moving);
    balance.work += start;
    const Solved solved = newton_pass(body, first_pass, enough, work - balance.work - residual);
    balance.work += solved.work;
    balance.cycles += solved.cycles;
    ++balance.passes;
  }
}

}  // namespace

Multigrid::Requirement Multigrid::required(const Model& model, const Limits& limits) noexcept {
  if (!is_elastic(model) || !in_range(limits)) return {};
  const MultigridView& view = model.view().multigrid;
  Arena counting;
  static_cast<void>(place_elastic_body(counting, view, limits.max_holds));
  Requirement requirement;
  requirement.bytes = static_cast<std::size_t>(counting.bytes());
  requirement.least_work = state_work(view, limits.max_loads, limits.max_holds) + least_balance_work(view);
  requirement.cycle_work = iteration_work(view);
  requirement.shown_work = shown_work(view);
  requirement.stress_work = stress_work(view);
  return requirement;
}

Multigrid::Created Multigrid::create(const Model& model, const Limits& limits, std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  if (!is_elastic(model)) {
    created.error = CreateError::unsupported_model;
    return created;
  }
  if (!in_range(limits)) {
    created.error = CreateError::bad_limits;
    return created;
  }
  created.requested = required(model, limits).bytes;
  if (!memory_fits(memory, CreateError::arena_too_small, CreateError::arena_misaligned, created)) return created;
  Arena arena(memory.data());
  ElasticBody& body = *place_elastic_body(arena, model.view().multigrid, limits.max_holds);
  begin_elastic_body(body);
  body.max_loads = limits.max_loads;
  body.tolerance = limits.tolerance;
  created.body.body_ = &body;
  return created;
}

Multigrid::StepReport Multigrid::step(const Inputs& inputs, Budget budget, const Response& response) noexcept {
  ElasticBody& body = *body_;
  StepReport report;
  Refusal refusal = check_loads(body, inputs.loads);
  if (refusal.status == Status::ok) refusal = mark_holds(body, inputs.holds);
  if (refusal.status == Status::ok && inputs.gravity != nullptr && !is_finite(*inputs.gravity)) {
    refusal.status = Status::held_not_finite;
  }
  if (refusal.status == Status::ok) refusal.status = check_response(body, inputs, response);
  const std::uint64_t fixed = answer_work(body, inputs, response);
  const std::uint64_t least = fixed + least_balance_work(body.view);
  if (refusal.status == Status::ok && budget.work < least) refusal.status = Status::held_over_budget;
  report.status = refusal.status;
  report.refused = refusal.input;
  if (!answered(report.status)) return report;

  keep_frames(body);
  predict(body, inputs.holds);
  const double loads = set_loads(body, inputs);
  const Balance found = balance(body, loads, body.tolerance, budget.work - fixed);
  report.work = fixed + found.work;
  report.cycles = found.cycles;
  report.passes = found.passes;
  report.residual = static_cast<float>(found.residual);
  if (!is_sound(body) || !std::isfinite(found.residual)) {
    stop(body);
    report.status = Status::held_overflow;
    return report;
  }
  take_over(body);
  report.status = found.residual <= static_cast<double>(body.tolerance) ? Status::ok : Status::coarser;
  for (std::size_t i = 0; i < response.reaction.size(); ++i) {
    const Float4 reaction = -body.residual[inputs.holds[i].vertex];
    response.reaction[i] = {reaction[0], reaction[1], reaction[2]};
  }
  copy_displacements(body, response.chosen, response.displacement);
  copy_shown(body, response.shown);
  copy_stress(body, response.stress);
  return report;
}

Multigrid::Energy Multigrid::energy() const noexcept {
  ElasticBody& body = *body_;
  multiply_mass(body.groups, body.state.velocity.data(), body.inertia);
  double twice = 0;
  for (std::size_t v = 0; v < body.inertia.size(); ++v) {
    const Float4 product = body.inertia[v] * body.state.velocity[v];
    twice += static_cast<double>((product[0] + product[1]) + product[2]);
  }
  return {static_cast<float>(0.5 * twice),
          elastic_energy(body.measure, body.groups, body.frame, body.state.displacement.data())};
}

}  // namespace greenloop
