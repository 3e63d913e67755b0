#pragma once

#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/loop.hpp"

namespace greenloop {

/// What the loop notes of a step, whichever solver made it.
struct LoopReport {
  Status status = Status::ok;
  std::uint64_t work = 0;              ///< units
  std::uint32_t constraint_level = 0;  ///< level of the answer
  std::uint32_t field_level = 0;       ///< finest level of detail in the field
};

/// What the loop drives: a body of any solver, with the buffers of its answer. No call uses heap, lock, system call,
/// exception or clock.
class LoopBody {
 public:
  /// One step within `work` units, with the displacement of all nodes if it is wanted.
  [[nodiscard]] virtual LoopReport step(std::span<const Constraint> constraints, std::uint64_t work,
                                        bool with_field) noexcept = 0;

  /// [3 * constraints of the last step] N, as of the last one that was answered.
  [[nodiscard]] virtual std::span<const float> force() const noexcept = 0;
  /// [4 * nodes] m, as of the last step that was answered with a field; zero before.
  [[nodiscard]] virtual std::span<const float> field() const noexcept = 0;

 protected:
  ~LoopBody() = default;
};

}  // namespace greenloop
