#pragma once

#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/local_model.hpp"
#include "runtime/loop.hpp"
#include "runtime/mask.hpp"
#include "runtime/model.hpp"
#include "runtime/prices.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct Body;  // what a body keeps in its arena: runtime/elastostatic/body.hpp

/// Contact with a linear elastic body by the capacitance matrix algorithm on wavelet-compressed Green's functions
/// (James & Pai 2003, sections 3.2, 5.4 and 7) in two-sided standard form (Beylkin, Coifman & Rokhlin 1991).
class Elastostatic {
 public:
  /// What a body must be able to do, fixed before the loop starts.
  struct Limits {
    std::uint32_t max_contacts = 64;   ///< 1..4096, constraints per step
    std::uint32_t cached_factors = 8;  ///< 1..1024, capacitance factors kept
    bool forces_only = false;          ///< no fields: little memory, and no couplings to be mirrored
    bool keep_capacitance = false;     ///< capacitance matrices beside their factors, for `compliance`
    std::uint32_t glide_cycles = 16;   ///< 1..256, steps in which the forces go over to another level; 1: at once
    std::uint64_t refining_work = ~std::uint64_t{0};  ///< units of a step up to which it prepares a finer level
    std::uint32_t iterations = 0;  ///< 0..1024 for unilateral contacts, at most 256 of them, in pairs of sweeps; 0:
                                   ///< they are refused
    std::uint32_t max_forces = 0;  ///< 0..4096, nodes that known forces are on in a step, those of masks each time; 0:
                                   ///< constraints of other kinds than hold are refused
    bool model_loads = false;      ///< the model's loads may act, gravity and pressures
    bool mixed_contacts = false;   ///< contacts of kinds normal and mask; false: they are refused
    std::uint32_t max_points = 0;  ///< 0..4096, points whose displacement may be asked for at once; 0: none, nor what
                                   ///< masks meet
    Prices prices{};               ///< that make work units of what a step does
  };

  /// The loop that a model is meant for, as its scene has it ([budget] of docs/scene.md).
  struct Intent {
    Limits limits;    ///< the scene's contacts and loads, the rest by default: what `budget` was computed for
    Budget budget;    ///< the scene's work or share of a period, else what the build chose: enough for the finest level
    float rate = 0;   ///< Hz, steps per second
    float share = 1;  ///< of a period that a step may take, above 0 and at most 1; 1: or the scene has none
  };

  /// What Limits cost. least_work: coarsest level, all constraints, coarsest field.
  struct Requirement : greenloop::Requirement {
    std::uint64_t selected_work = 0;  ///< of displacements and of masked_compliance, a call; 0: they are not answered
    std::uint64_t worst_work[layout::max_levels] = {};  ///< of a step by its StepReport::constraint_level
  };

  /// What acts on a body in a step beside its constraints, and how stiff it is.
  struct Loads {
    std::span<const Mask> masks{};  ///< that constraints of kinds pattern and mask name
    Vec3 gravity{};  ///< m/s^2, of the whole body, where the model has accelerations (ElastostaticView::has_gravity)
    std::span<const float> pressure{};         ///< Pa, of the model's first pressures, in their order
    float stiffness = 1;                       ///< 2^-20..2^20, Young's modulus over the model's
    std::span<const DirectedMask> directed{};  ///< that constraints of kinds normal and along name
  };

  /// The answer of a step; the caller owns the memory. The size of `displacement` says which nodes are displaced: all,
  /// or those of the coarser levels, which come first in the file (Model::node_count). Floats of the caller's are seen
  /// as vectors by as_vec3 and as_vec4.
  struct Response {
    std::span<Vec3> force;  ///< [constraints] N, the force that holds each, or that is known, in their order; along a
                            ///< directed mask its amount and two zeros
    std::span<Vec4> displacement;  ///< [nodes of levels 0..q] m; empty: none is wanted
  };

  /// How a step was answered.
  struct StepDetails {
    bool cached_factor = false;          ///< the capacitance factor came from the cache, unchanged
    std::uint16_t held_contacts = 0;     ///< constraints that the answer holds
    std::uint16_t waiting_contacts = 0;  ///< the others: they are new and have no force yet
    std::uint32_t changed_nodes = 0;     ///< nodes put into a cached factor and taken out of it, to make this one
    float glide = 1;  ///< share of constraint_level in the forces; the rest is of the level before it
    float level_difference =
        0;                   ///< N, largest component of the older level's forces minus the newer one's; 0: no glide
    double switch_work = 0;  ///< J, elastic energy that this step's change of `glide` put into the body
    std::uint64_t needed_work =
        0;  ///< units that the budget had to hold for this answer, bounds of what is counted later
    std::uint64_t pending_work = 0;  ///< units, at most, until the factor of a finer level is complete; 0: none is made
  };

  struct StepReport : greenloop::StepReport {
    std::uint32_t constraint_level = 0;  ///< level at which they were resolved
    std::uint32_t field_level = 0;       ///< finest level whose details are in the field (interpolated beyond)
    float error = 0;  ///< largest relative error, of forces and field, that answers like this one were measured to have
                      ///< offline (docs/loop.md, "Errors"); infinity: not measured, or not answered
    StepDetails details;
  };

  /// The answer to unilateral contacts.
  struct UnilateralResponse : Response {
    std::span<ContactState> state;  ///< [contacts] what each does; empty: not wanted
    std::span<Vec4> gap;            ///< [contacts] m, from where it touches and has not slid; empty: not wanted
    std::span<float> yield;         ///< [contacts] m, how far its own force pushes each, >= 0; empty: not wanted
    std::span<Vec4> by_loads;       ///< [contacts] m, where each would be without contact forces; empty: not wanted
  };

  struct UnilateralReport : StepReport {
    float residual = 0;            ///< of the contact laws, relative: docs/loop.md, "Unilateral contacts"
    std::uint32_t iterations = 0;  ///< that were made
  };

  struct Created;

  /// What the scene asked for. Start-up; work: constant.
  [[nodiscard]] static Intent intended(const Model& model) noexcept;

  /// Bytes and worst-case work for `limits`. Start-up; linear in nodes times levels, in blocks, and, for every 512
  /// nodes, in nodes. Zero bytes if `create` would refuse for another reason than memory.
  [[nodiscard]] static Requirement required(const Model& model, const Limits& limits) noexcept;

  /// Carves `memory` with the routine that `required` counts with. The model's bytes and `memory` must outlive the
  /// body. Refuses a model whose refinement is not that of a subdivided triangulation, where a force on a node reaches
  /// more than 192 nodes of a coarser level, or with 2^28 nodes or 2^30 blocks, or that is ready for other nodes
  /// being read than its own, unless `forces_only`. Start-up; linear in the model's bytes.
  [[nodiscard]] static Created create(const Model& model, const Limits& limits, std::span<std::byte> memory) noexcept;

  /// One cycle of the loop: finds the forces that hold `constraints` where they are and the displacement of every
  /// node, as finely as fits the budget by closed-form work (docs/budgets.md). No heap, lock, system call, exception or
  /// clock; same model, limits, history, constraints and budget give the same bits. Work: at most budget.work.
  StepReport step(std::span<const Constraint> constraints, Budget budget, const Response& response) noexcept;

  /// The same with what else acts (James & Pai 2001, section 4.2): known forces, on nodes and by masks, reduce what the
  /// contacts have to do to stand where they are held. They are resolved at the level of the contacts: below the finest
  /// one, and in steps without contacts that the budget does not hold there, a force acts on the node that stands for
  /// its own. Forces of contacts scale with the stiffness, displacements by known forces with its inverse. With
  /// Limits::mixed_contacts masks may be held, and nodes and masks along directions alone (docs/loop.md, "Mixed
  /// contacts"); one that depends on the others at the finest level makes the step held_singular.
  StepReport step(std::span<const Constraint> constraints, const Loads& loads, Budget budget,
                  const Response& response) noexcept;

  /// The same for rigid surfaces that push nodes and rub against them, but do not pull: finds forces and displacements
  /// that obey the laws of Signorini and Coulomb (James & Pai 2001, section 6; docs/loop.md). Forces of what answers
  /// short of budget obey these laws too: each pushes and lies within its cone of friction; what is not exact then is
  /// where the nodes are. Refuses contacts unless Limits::iterations is positive. Work: at most budget.work.
  UnilateralReport step(std::span<const UnilateralContact> contacts, const Loads& loads, Budget budget,
                        const UnilateralResponse& response) noexcept;

  /// The compliance between two contacts, by their places among those of the last answer, at the levels that it was
  /// answered at: the displacement of i per force at j, m/N, of nodes that share a column the column's. While a glide
  /// is under way (StepDetails::glide below 1) the answer's forces are not those that it gives. block: 3 c + r,
  /// displacement r per force c. False, and nothing is written, unless the capacitance is kept (Limits), the last step
  /// was answered and its factor is still in the cache, which one factor of a finer level may replace. For the loop;
  /// work: constant but for a look into the cache.
  bool compliance(std::uint32_t i, std::uint32_t j, std::span<float, 9> block) const noexcept;

  // Selected answers (James & Pai 2001, section 4.3). Each returns the work units that it spent beside those of steps;
  // 0, and nothing is written, where it is refused. What a step after it answers is the same as without it.

  /// Displacements of points of the surface by all that acts in the last answer, m, as they are in its whole field but
  /// for rounding. [as many] For the loop; at most Requirement::selected_work: what forces and points reach, however
  /// many nodes the body has. Refused without an answer, and with more points than Limits::max_points, nodes that the
  /// model does not have or weights that are not finite.
  std::uint64_t displacements(std::span<const MeshPoint> points, std::span<Vec3> displacement) noexcept;

  /// The displacement of a node of the domain per force on a mask at the finest level, of the model's own stiffness:
  /// the sum over the mask of its parts of the compliance (equation 32). block: as of `compliance`, m/N. For the loop;
  /// at most Requirement::selected_work. Refused without Limits::max_points, with a node outside of the domain, or a
  /// mask that is empty, of more nodes than max_contacts and max_forces together, or of nodes that are not touchable.
  std::uint64_t masked_compliance(std::uint32_t node, const Mask& mask, std::span<float, 9> block) noexcept;

  /// The stiffness of a point-like contact anywhere on the surface, N/m, as of runtime/stiffness.hpp: the mean of its
  /// corners' by the point's weights (equation 34), `rigid` along all axes where a corner is held in place. masks: of
  /// the corners, make_mask(at_node(corner)); of one that is held in place or weighs nothing any. capped: none is
  /// stiffer than `rigid` (section 6.4). For the loop; at most three times Requirement::selected_work. Refused as
  /// masked_compliance is.
  std::uint64_t stiffness(const MeshPoint& point, std::span<const Mask, 3> masks, float rigid, bool capped,
                          std::span<float, 9> stiffness) noexcept;

  /// How the forces of the last answer follow the motions of the rigid surfaces, until the next step (James & Pai 2001,
  /// section 5; docs/loop.md, "A faster loop"). points: [contacts] of that answer in their order: the tool that each is
  /// of, and the lever about which its torque is taken and it turns, m. tools: 1 .. LocalModel::most_tools. components:
  /// 3 or 6. length: m, above 0. Returns the work units that it took; at most local_model_work. For the loop. Refused,
  /// 0 and nothing is written, unless the last step was one of unilateral contacts and answered, and where a number is
  /// out of these ranges.
  std::uint64_t local_model(std::span<const ToolPoint> points, std::uint32_t tools, std::uint32_t components,
                            float length, LocalModel& model) noexcept;

  /// Work units of `local_model` for so many contacts.
  [[nodiscard]] std::uint64_t local_model_work(std::uint32_t contacts, std::uint32_t tools,
                                               std::uint32_t components) const noexcept;

 private:
  Body* body_ = nullptr;
};

struct Elastostatic::Created : Creation {
  Elastostatic body;
};

}  // namespace greenloop
