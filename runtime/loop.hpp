#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace greenloop {

// What the loops of all solvers have in common. A solver is a class with
//   required(model, limits)        what its limits cost, before anything is allocated
//   create(model, limits, memory)  a body in the caller's memory
//   step(inputs, budget, response) one cycle of the loop, and its report

/// Work that a step may spend, in work units: one unit is one multiply-add of the algorithm (a 3x3 block times a vector
/// is 9).
struct Budget {
  std::uint64_t work = 0;
};

/// What came of a step. On any `held_` status nothing was written, so that the caller's buffers still hold the last
/// good answer, and the body stays usable.
enum class Status : std::uint8_t {
  ok,       ///< answered at the finest constraint level alone and with all details of the nodes that were asked for
  coarser,  ///< answered within the budget at a coarser level, or gliding to the finest
  held_not_finite,     ///< a constraint's value is NaN or infinite
  held_out_of_range,   ///< a constraint names no node of the model, or there are more than the limits allow
  held_not_touchable,  ///< a constraint names a node that the scene did not declare touchable
  held_duplicate,      ///< two constraints name the same node
  held_response_size,  ///< a response buffer has the wrong size or alignment
  held_over_budget,    ///< the budget is below Requirement::least_work: refused
  held_singular,       ///< the capacitance matrix is not positive definite to working precision
  held_overflow,       ///< the answer would not be finite, or comes too near the largest float
  held_unsupported,    ///< a constraint is of a kind that the solver does not know
  held_bad_surface,  ///< of a unilateral contact: its normal is not of unit length, its weights sum to more than 1, or
                     ///< a number that must not be negative is
  held_unsolved,     ///< the laws of unilateral contacts have no finite solution: numbers are too large, or a point's
                     ///< compliance is not positive definite to working precision
  held_illegal_impulse,  ///< an impulse may not follow the last one
};
inline constexpr std::size_t statuses = 14;

/// Whether a step was answered, so that its buffers hold this step's answer.
constexpr bool answered(Status status) { return status <= Status::coarser; }

/// What some limits cost, in closed form, before anything is allocated.
struct Requirement {
  std::size_t bytes = 0;  ///< of the arena
  std::size_t alignment = 64;
  std::uint64_t least_work = 0;  ///< the smallest budget that `step` accepts
};

/// What every step reports.
struct StepReport {
  static constexpr std::uint32_t no_constraint = 0xffffffff;

  Status status = Status::ok;
  std::uint32_t refused = no_constraint;  ///< the first constraint, by its place among them, that `status` is about
  std::uint64_t work = 0;                 ///< units spent, never more than the budget
};

enum class CreateError : std::uint8_t {
  none,
  arena_too_small,
  arena_misaligned,
  bad_limits,
  unsupported_model,  ///< of another problem, or beyond what the solver holds: see its `create`
  mismatched_models,  ///< of two models: they are not of the same surface
};

/// What `create` says of the memory it was given.
struct Creation {
  CreateError error = CreateError::none;
  std::size_t requested = 0;  ///< bytes; of a body those in use, from its creation to its end: its high-water mark
  std::size_t available = 0;
  std::size_t missing = 0;
  explicit operator bool() const noexcept { return error == CreateError::none; }
};

}  // namespace greenloop
