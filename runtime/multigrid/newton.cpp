#include "runtime/multigrid/newton.hpp"

#include <cstddef>

#include "runtime/multigrid/turned_cycle.hpp"

namespace greenloop {
namespace {

/// Sum in double precision, so that bodies of many vertices keep their digits.
class Sum {
 public:
  void add(Float4 product) {
    xy_ += static_cast<double>(product[0]) + static_cast<double>(product[1]);
    z_ += static_cast<double>(product[2]);
  }
  [[nodiscard]] double value() const { return xy_ + z_; }

 private:
  double xy_ = 0, z_ = 0;
};

double dot(std::span<const Float4> a, std::span<const Float4> b, std::size_t count) {
  Sum sum;
  for (std::size_t v = 0; v < count; ++v) sum.add(a[v] * b[v]);
  return sum.value();
}

void add_scaled(std::span<Float4> sum, float scale, std::span<const Float4> x) {
  for (std::size_t v = 0; v < x.size(); ++v) sum[v] += splat(scale) * x[v];
}

/// What is held has no part in the change.
void mask(const ElasticBody& body, std::span<Float4> field) {
  for (std::size_t v = 0; v < field.size(); ++v) field[v] *= splat(body.moves[v]);
}

void move(ElasticBody& body) {
  const Newmark& newmark = body.newmark;
  const float acceleration = 1 / newmark.displacement_per_acceleration();
  add_scaled(body.next.displacement, 1, body.change);
  add_scaled(body.next.velocity, acceleration * newmark.rate_per_acceleration(), body.change);
  add_scaled(body.next.acceleration, acceleration, body.change);
}

/// image = operator direction; their product.
double meet_direction(ElasticBody& body) {
  multiply_elements(body.groups, body.frame, body.newmark.stiffness_scale(), body.newmark.mass_scale(),
                    body.direction.data(), body.image);
  mask(body, body.image);
  return dot(body.direction, body.image, body.free());
}

void go(ElasticBody& body, double step) {
  add_scaled(body.change, static_cast<float>(step), body.direction);
  add_scaled(body.rest, static_cast<float>(-step), body.image);
}

/// As far along the last acceleration as lessens the energy of the step most: what a short step left out of balance
/// comes in the next ones, and what swings from step to step is not followed.
void follow_last_acceleration(ElasticBody& body) {
  for (std::size_t v = 0; v < body.free(); ++v) {
    body.direction[v] = splat(body.moves[v]) * body.state.acceleration[v];
  }
  const double curvature = meet_direction(body);
  if (curvature > 0) go(body, dot(body.direction, body.rest, body.free()) / curvature);
  for (Float4& d : body.direction) d = Float4{};
}

}  // namespace

Imbalance find_residual(ElasticBody& body) noexcept {
  const ElasticState& state = body.next;
  find_frames(body.measure, body.groups, state.displacement.data(), body.quaternion, body.frame);
  for (std::size_t v = 0; v < body.inertia.size(); ++v) {
    body.residual[v] = body.force[v];
    body.inertia[v] = (state.acceleration[v] + splat(body.newmark.mass_damping) * state.velocity[v]) - body.gravity;
  }
  subtract_forces(body.measure, body.groups, body.frame, state.displacement.data(), state.velocity.data(),
                  body.newmark.stiffness_damping, body.inertia.data(), body.residual.data());
  Sum moving, held;
  for (std::size_t v = 0; v < body.residual.size(); ++v) {
    const Float4 square = body.residual[v] * body.residual[v];
    (body.moves[v] > 0 ? moving : held).add(square);
  }
  return {moving.value(), held.value()};
}

Solved newton_pass(ElasticBody& body, bool first, double goal, std::uint64_t work) noexcept {
  const std::uint64_t each = iteration_work(body.view);
  const std::size_t free = body.free();
  const std::span<Float4> r = body.rest, z = body.preconditioned;
  for (std::size_t v = 0; v < r.size(); ++v) {
    r[v] = splat(body.moves[v]) * body.residual[v];
    body.change[v] = Float4{};
    body.direction[v] = Float4{};
  }
  turn_vertices(body);
  if (first) follow_last_acceleration(body);
  Solved solved;
  double rr = dot(r, r, free), rz = 0, step = 0;
  while (rr > goal && solved.work + each <= work) {
    turned_cycle(body, r.data(), z.data());
    // (r - r before) . z = -step image . z
    const double beta = solved.cycles == 0 ? 0 : -step * dot(body.image, z, free) / rz;
    for (std::size_t v = 0; v < free; ++v) {
      body.direction[v] = z[v] + splat(static_cast<float>(beta)) * body.direction[v];
    }
    rz = dot(r, z, free);
    const double curvature = meet_direction(body);
    ++solved.cycles;
    solved.work += each;
    if (!(curvature > 0) || !(rz > 0)) break;
    step = rz / curvature;
    go(body, step);
    rr = dot(r, r, free);
  }
  move(body);
  return solved;
}

}  // namespace greenloop
