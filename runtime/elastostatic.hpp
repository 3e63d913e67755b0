#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/model.hpp"

namespace greenloop {

struct Body;  // what a body keeps in its arena: runtime/elastostatic/body.hpp

/// What a body must be able to do, fixed before the loop starts.
struct Limits {
  std::uint32_t max_contacts = 64;   ///< 1..4096, contacts per step
  std::uint32_t cached_factors = 8;  ///< 1..1024, capacitance factors kept
  bool forces_only = false;          ///< no fields: little memory, and no couplings to be mirrored
  std::uint32_t glide_cycles = 16;   ///< 1..256, steps in which the forces go over to another level; 1: at once
  std::uint64_t refining_work = ~std::uint64_t{0};  ///< units of a step up to which it prepares a finer level
};

/// Work a step may spend, in work units: one unit is one multiply-add of the algorithm (one block times a vector is 9).
struct Budget {
  std::uint64_t work = 0;
};

/// The loop that a model is meant for, as its scene has it ([budget] of docs/scene.md).
struct Intent {
  Limits limits;   ///< the scene's contacts, the rest by default: what `budget` was computed for
  Budget budget;   ///< the scene's work per step, or what the build chose: enough for the finest level
  float rate = 0;  ///< Hz, steps per second
};

/// A node held at a prescribed displacement.
struct Contact {
  std::uint32_t node = 0;      ///< file index of a touchable node
  float displacement[3] = {};  ///< m
};

enum class Status : std::uint8_t {
  ok,       ///< answered at the finest constraint level alone and with all details of the nodes that were asked for
  coarser,  ///< answered within the budget at a coarser level, or gliding to the finest
  held_not_finite,     ///< a contact's displacement is NaN or infinite: nothing changed, the last good response is held
  held_out_of_range,   ///< a contact names no node of the model, or more contacts than Limits allow
  held_not_touchable,  ///< a contact names a node that the scene did not declare touchable
  held_duplicate,      ///< two contacts name the same node
  held_response_size,  ///< a response buffer has the wrong size or alignment
  held_over_budget,    ///< the budget is below Requirement::least_work: refused
  held_singular,       ///< the capacitance matrix is not positive definite to working precision
  held_overflow,       ///< the answer would not be finite, or comes too near the largest float
};

/// The answer of a step; the caller owns the memory. The size of `displacement` says which nodes are displaced: all, or
/// those of the coarser levels, which come first in the file (Model::view, LevelView::node_begin). On any `held_`
/// status nothing is written, so that the same buffers still hold the last good step.
struct Response {
  std::span<float> force;  ///< [3 * contacts] N, the force that holds each contact, in the order of the contacts
  std::span<float>
      displacement;  ///< [4 * nodes of levels 0..q] m, x y z 0 per node, 16-byte aligned; empty: none is wanted
};

struct StepReport {
  static constexpr std::uint32_t no_contact = layout::none;

  Status status = Status::ok;
  bool cached_factor = false;          ///< the capacitance factor came from the cache, unchanged
  std::uint32_t refused = no_contact;  ///< the first contact, by its place among them, that `status` is about
  std::uint32_t constraint_level = 0;  ///< level at which the contacts were resolved, of a mixed set the coarser one
  std::uint32_t finer_level = 0;       ///< of a mixed set the finer one, else the same
  std::uint32_t finer_contacts = 0;    ///< contacts that were resolved at finer_level
  std::uint32_t field_level = 0;       ///< finest level whose details are in the field (interpolated beyond)
  float error = 0;                     ///< Level::field_error of that constraint level, as measured offline
  std::uint32_t changed_nodes = 0;     ///< nodes put into a cached factor and taken out of it, to make this one
  std::uint64_t work = 0;              ///< units spent, never more than the budget
  float glide = 1;                     ///< share of constraint_level in the forces; the rest is of the level before it
  float level_difference = 0;  ///< N, largest component of the older level's forces minus the newer one's; 0: no glide
  double switch_work = 0;      ///< J, elastic energy that this step's change of `glide` put into the body
  std::uint64_t pending_work = 0;  ///< units, at most, until the factor of a finer level is complete; 0: none is made
};

/// What Limits cost, in closed form, before anything is allocated.
struct Requirement {
  std::size_t bytes = 0;  ///< of the arena
  std::size_t alignment = 64;
  std::uint64_t least_work = 0;  ///< the smallest budget `step` accepts: coarsest level, all contacts, coarsest field
  std::uint64_t worst_work[layout::max_levels] = {};  ///< of a step by its StepReport::constraint_level
};

enum class CreateError : std::uint8_t {
  none,
  arena_too_small,
  arena_misaligned,
  bad_limits,
  unsupported_model,  ///< its refinement is not that of a subdivided triangulation, a force on a node reaches more than
                      ///< 192 nodes of a coarser level, or it has 2^28 nodes or 2^30 blocks
};

/// Contact with a linear elastic body by the capacitance matrix algorithm on wavelet-compressed Green's functions
/// (James & Pai 2003, sections 3.2, 5.4 and 7) in two-sided standard form (Beylkin, Coifman & Rokhlin 1991).
class Elastostatic {
 public:
  struct Created;

  /// What the scene asked for. Start-up; work: constant.
  [[nodiscard]] static Intent intended(const Model& model) noexcept;

  /// Bytes and worst-case work for `limits`. Start-up; linear in nodes times levels, in blocks, and, for every 512
  /// nodes, in nodes. Zero bytes if `create` would refuse for another reason than memory.
  [[nodiscard]] static Requirement required(const Model& model, const Limits& limits) noexcept;

  /// Carves `memory` with the routine that `required` counts with. `model` and `memory` must outlive the body.
  /// Start-up; linear in the model's bytes.
  [[nodiscard]] static Created create(const Model& model, const Limits& limits, std::span<std::byte> memory) noexcept;

  /// One cycle of the loop: finds the forces that hold `contacts` where they are and the displacement of every node,
  /// as finely as fits the budget by closed-form work (docs/runtime.md, "Budgets"). No heap, lock, system call,
  /// exception or clock; same model, limits, history, contacts and budget give the same bits. Work: at most
  /// budget.work.
  StepReport step(std::span<const Contact> contacts, Budget budget, const Response& response) noexcept;

 private:
  Body* body_ = nullptr;
};

struct Elastostatic::Created {
  CreateError error = CreateError::none;
  std::size_t requested = 0, available = 0, missing = 0;  ///< bytes
  Elastostatic body;
  explicit operator bool() const noexcept { return error == CreateError::none; }
};

}  // namespace greenloop
