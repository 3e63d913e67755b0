#pragma once

#include <cstdint>
#include <span>

#include "runtime/vec.hpp"

namespace greenloop {

/// The tools' forces as they follow the tools' motions while no contact changes its state: what a loop that is faster
/// than the steps evaluates between two of them (James & Pai 2001, section 5). It is the derivative of the last contact
/// problem with the slips of that step, so that it holds for the whole way from the step before. A value without
/// pointers: it may be handed over from thread to thread.
struct LocalModel {
  static constexpr std::uint32_t most_tools = 3;
  static constexpr std::uint32_t most_components = 6 * most_tools;

  std::uint32_t tools = 0;
  std::uint32_t components = 0;        ///< of a tool's motion: 3, a translation, or 6, then a rotation vector
  float length = 0;                    ///< m, what a turn by a radian counts as in `range`
  float range = 0;                     ///< m, a motion up to which no contact opens, closes, begins to slip or to stick
  float wrench[most_components] = {};  ///< of the body on each tool at the step: force, N, and torque, N m
  float change[most_components][most_components] = {};  ///< of the wrenches per unit of a component of the motion

  /// Length of a motion, m: [components] of each tool since the step, m and rad. Within `range` the wrenches are right.
  [[nodiscard]] float motion_length(std::span<const float> motion) const noexcept;

  /// Wrenches [6] of the body on each tool, N and N m. For the loop; components times 6 multiply-adds for each pair of
  /// tools.
  void evaluate(std::span<const float> motion, std::span<float> wrenches) const noexcept;
};

/// Whose a contact is, and where it is seen from the tool's point for torques and turns, m.
struct ToolPoint {
  std::uint32_t tool = 0;
  Vec4 lever;
};

}  // namespace greenloop
