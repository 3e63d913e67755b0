#include "runtime/elastostatic/known_forces.hpp"

#include <cmath>
#include <cstddef>

namespace greenloop {
namespace {

// a part of a force, over the stiffness scale
void add_force(std::uint32_t node, const Constraint& constraint, float part, KnownForces& forces, float& sum) {
  float* const force = forces.force + std::size_t{3} * forces.count;
  for (std::size_t r = 0; r < 3; ++r) {
    force[r] = part * constraint.value[r];
    sum += std::fabs(force[r]);
  }
  forces.node[forces.count++] = node;
}

}  // namespace

void KnownForces::carve(Arena& arena, const ModelView& view, std::uint32_t forces) noexcept {
  node = arena.take<std::uint32_t>(forces);
  column = arena.take<std::uint32_t>(forces);
  force = arena.take<float>(std::uint64_t{3} * forces);
  touched.carve(arena, view);
}

std::uint64_t count_forces(std::span<const Constraint> constraints, std::span<const Mask> masks) noexcept {
  std::uint64_t count = 0;
  for (const Constraint& constraint : constraints) {
    const bool masked = constraint.kind == Constraint::Kind::pattern;
    count += masked && constraint.node < masks.size()    ? masks[constraint.node].node.size()
             : constraint.kind == Constraint::Kind::hold ? 0
                                                         : 1;
  }
  return count;
}

std::uint32_t list_forces(std::span<const Constraint> constraints, std::span<const Mask> masks, float stiffness,
                          KnownForces& forces, Constraint* held, float& sum) noexcept {
  std::uint32_t holds = 0;
  forces.count = 0;
  for (const Constraint& constraint : constraints) {
    if (constraint.kind == Constraint::Kind::hold) {
      held[holds++] = constraint;
    } else if (constraint.kind == Constraint::Kind::force) {
      add_force(constraint.node, constraint, 1 / stiffness, forces, sum);
    } else {
      const Mask& mask = masks[constraint.node];
      for (std::size_t k = 0; k < mask.node.size(); ++k) {
        add_force(mask.node[k], constraint, mask.weight[k] / stiffness, forces, sum);
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
