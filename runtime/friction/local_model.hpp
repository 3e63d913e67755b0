#pragma once

#include <cstdint>
#include <span>

#include "runtime/friction/contact_problem.hpp"
#include "runtime/local_model.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

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
  /// length: m > 0, what a turn counts as: about the size of the tools. Returns the work units that it took. For the
  /// loop.
  std::uint64_t build(ContactProblem& problem, std::span<const ToolPoint> points, std::uint32_t tools,
                      std::uint32_t components, float length, LocalModel& model) noexcept;

 private:
  struct Gradients;
  [[nodiscard]] static float state_range(const ContactProblem::Contact& contact, const Gradients& of) noexcept;
  void move(std::span<const ToolPoint> points, std::uint32_t tool, std::uint32_t component) noexcept;

  Float4* gap_ = nullptr;    ///< change of each candidate's gap, and then of its displacement
  Float4* force_ = nullptr;  ///< change of its force
  Gradients* gradients_ = nullptr;
};

}  // namespace greenloop
