#include "runtime/friction/local_model.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace greenloop {

/// Squares, summed over the components of a motion, of what changes at one contact per metre.
struct LocalModelBuilder::Gradients {
  float pressed, dragged;    ///< normal and friction force
  float separated, slipped;  ///< normal and tangential displacement
};

namespace {

Float4 load(const Vec4& v) { return Float4{v.x, v.y, v.z, 0.0F}; }

// adds a force of the body on a tool, and its torque
void add(Float4 force, Float4 lever, float* wrench) {
  const Float4 torque = cross(lever, force);
  for (std::size_t k = 0; k < 3; ++k) {
    wrench[k] += force[k];
    wrench[3 + k] += torque[k];
  }
}

float tangential(Float4 normal, Float4 v) {
  const Float4 tangent = v - splat(dot3(normal, v)) * normal;
  return dot3(tangent, tangent);
}

// how far a margin lasts that shrinks by at most `slope` per metre
float lasting(float margin, float slope) { return slope > 0 ? std::max(margin, 0.0F) / slope : FLT_MAX; }

}  // namespace

float LocalModelBuilder::state_range(const ContactProblem::Contact& contact, const Gradients& of) noexcept {
  const Float4 normal = contact.law->normal;
  const float mu = contact.law->friction;
  const float pressed = dot3(normal, contact.force);
  const float until_open = lasting(pressed, std::sqrt(of.pressed));
  switch (contact.state) {
    case ContactState::open:
      return lasting(dot3(normal, contact.displacement), std::sqrt(of.separated));
    case ContactState::stick: {
      const float left = mu * pressed - std::sqrt(tangential(normal, contact.force));
      return std::min(until_open, lasting(left, mu * std::sqrt(of.pressed) + std::sqrt(of.dragged)));
    }
    case ContactState::slip:
      break;
  }
  const float slipped = std::sqrt(tangential(normal, contact.displacement));
  return mu > 0 ? std::min(until_open, lasting(slipped, std::sqrt(of.slipped))) : until_open;
}

float LocalModel::motion_length(std::span<const float> motion) const noexcept {
  float sum = 0;
  for (std::size_t c = 0; c < motion.size(); ++c) {
    const float metres = c % components < 3 ? motion[c] : length * motion[c];
    sum += metres * metres;
  }
  return std::sqrt(sum);
}

void LocalModel::evaluate(std::span<const float> motion, std::span<float> wrenches) const noexcept {
  for (std::size_t r = 0; r < std::size_t{6} * tools; ++r) {
    wrenches[r] = wrench[r];
  }
  for (std::size_t c = 0; c < std::size_t{components} * tools; ++c) {
    for (std::size_t r = 0; r < std::size_t{6} * tools; ++r) {
      wrenches[r] += change[c][r] * motion[c];
    }
  }
}

void LocalModelBuilder::carve(Arena& arena, std::uint32_t candidates) noexcept {
  gap_ = arena.take<Float4>(candidates);
  force_ = arena.take<Float4>(candidates);
  gradients_ = arena.take<Gradients>(candidates);
}

// the gaps' change by a unit of one component of a tool's motion
void LocalModelBuilder::move(std::span<const ToolPoint> points, std::uint32_t tool, std::uint32_t component) noexcept {
  Float4 axis{};
  axis[component % 3] = 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Float4 moved = component < 3 ? axis : cross(axis, load(points[i].lever));
    gap_[i] = points[i].tool == tool ? -moved : Float4{};
  }
}

std::uint64_t LocalModelBuilder::build(ContactProblem& problem, std::span<const ToolPoint> points, std::uint32_t tools,
                                       std::uint32_t components, float length, LocalModel& model) noexcept {
  model = {.tools = tools, .components = components, .length = length, .range = FLT_MAX};
  if (points.empty()) return 1;
  std::uint64_t work = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    gradients_[i] = {};
    add(-problem.contact(i).force, load(points[i].lever), model.wrench + std::size_t{6} * points[i].tool);
  }
  problem.linearise();
  for (std::uint32_t c = 0; c < tools * components; ++c) {
    move(points, c / components, c % components);
    work += problem.respond(gap_, force_);
    const float unit = c % components < 3 ? 1 : 1 / (length * length);
    for (std::size_t i = 0; i < points.size(); ++i) {
      add(-force_[i], load(points[i].lever), model.change[c] + std::size_t{6} * points[i].tool);
      const Float4 normal = problem.contact(i).law->normal;
      const float pressed = dot3(normal, force_[i]);
      const float separated = dot3(normal, gap_[i]);
      Gradients& of = gradients_[i];
      of.pressed += unit * pressed * pressed;
      of.separated += unit * separated * separated;
      of.dragged += unit * tangential(normal, force_[i]);
      of.slipped += unit * tangential(normal, gap_[i]);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    model.range = std::min(model.range, state_range(problem.contact(i), gradients_[i]));
  }
  return work;
}

}  // namespace greenloop
