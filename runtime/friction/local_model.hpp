#pragma once

#include <cstdint>
#include <span>

#include "runtime/friction/contact_problem.hpp"
#include "runtime/memory/arena.hpp"
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

/// Whose a candidate is, and where it is seen from the tool's point for torques and turns, m.
struct ToolPoint {
  std::uint32_t tool = 0;
  Vec4 lever;
};

/// Makes local models of contact problems.
class LocalModelBuilder {
 public:
  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint32_t candidates) noexcept;

  /// Work units of `build`, at most.
  static constexpr std::uint64_t work(const Prices& prices, std::uint64_t candidates, std::uint64_t tools,
                                      std::uint64_t components) {
    return tools * components * ContactProblem::response_work(prices, candidates);
  }

  /// Of the problem that was solved last. points: [candidates]. tools: 1 .. LocalModel::most_tools. components: 3 or 6.
  /// length: m > 0, what a turn counts as: about the size of the tools. For the loop.
  [[nodiscard]] LocalModel build(ContactProblem& problem, std::span<const ToolPoint> points, std::uint32_t tools,
                                 std::uint32_t components, float length) noexcept;

 private:
  struct Gradients;
  [[nodiscard]] static float state_range(const ContactProblem::Contact& contact, const Gradients& of) noexcept;
  void move(std::span<const ToolPoint> points, std::uint32_t tool, std::uint32_t component) noexcept;

  Float4* gap_ = nullptr;    ///< change of each candidate's gap, and then of its displacement
  Float4* force_ = nullptr;  ///< change of its force
  Gradients* gradients_ = nullptr;
};

}  // namespace greenloop
