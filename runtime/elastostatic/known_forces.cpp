#include "runtime/elastostatic/known_forces.hpp"

#include <cmath>
#include <cstddef>

namespace greenloop {
namespace {

using Kind = Constraint::Kind;

// over the stiffness scale
void add_force(std::uint32_t node, float x, float y, float z, KnownForces& forces, float& sum) {
  float* const force = forces.force + std::size_t{3} * forces.count;
  force[0] = x;
  force[1] = y;
  force[2] = z;
  for (std::size_t r = 0; r < 3; ++r) {
    sum += std::fabs(force[r]);
  }
  forces.node[forces.count++] = node;
}

// a part of a force
void add_force(std::uint32_t node, const Constraint& constraint, float part, KnownForces& forces, float& sum) {
  const float* const f = constraint.value;
  add_force(node, part * f[0], part * f[1], part * f[2], forces, sum);
}

}  // namespace

void KnownForces::carve(Arena& arena, const ModelView& view, std::uint32_t forces) noexcept {
  node = arena.take<std::uint32_t>(forces);
  column = arena.take<std::uint32_t>(forces);
  force = arena.take<float>(std::uint64_t{3} * forces);
  touched.carve(arena, view);
}

std::uint64_t count_forces(std::span<const Constraint> constraints, const Masks& masks) noexcept {
  std::uint64_t count = 0;
  for (const Constraint& constraint : constraints) {
    const std::uint32_t number = constraint.node;
    if (constraint.kind == Kind::pattern && number < masks.scalar.size()) {
      count += masks.scalar[number].node.size();
    } else if (constraint.kind == Kind::along && number < masks.directed.size()) {
      count += masks.directed[number].node.size();
    } else {
      count += is_contact(constraint) ? 0 : 1;
    }
  }
  return count;
}

std::uint32_t list_forces(std::span<const Constraint> constraints, const Masks& masks, float stiffness,
                          KnownForces& forces, Constraint* held, float& sum) noexcept {
  std::uint32_t holds = 0;
  forces.count = 0;
  for (const Constraint& constraint : constraints) {
    if (constraint.kind == Kind::hold) {
      held[holds++] = constraint;
    } else if (constraint.kind == Kind::force) {
      add_force(constraint.node, constraint, 1 / stiffness, forces, sum);
    } else if (constraint.kind == Kind::pattern) {
      const Mask& mask = masks.scalar[constraint.node];
      for (std::size_t k = 0; k < mask.node.size(); ++k) {
        add_force(mask.node[k], constraint, mask.weight[k] / stiffness, forces, sum);
      }
    } else if (constraint.kind == Kind::along) {
      const DirectedMask& mask = masks.directed[constraint.node];
      const float amount = constraint.value[0] / stiffness;
      for (std::size_t k = 0; k < mask.node.size(); ++k) {
        const Vec3& part = mask.part[k];
        add_force(mask.node[k], amount * part.x, amount * part.y, amount * part.z, forces, sum);
      }
    }
  }
  return holds;
}

void resolve_forces(const ModelView& view, const NodeFacts* facts, std::uint32_t level, KnownForces& forces) noexcept {
  for (std::uint32_t i = 0; i < forces.count; ++i) {
    forces.column[i] = column_of(view, facts, forces.node[i], level);
  }
}

}  // namespace greenloop
