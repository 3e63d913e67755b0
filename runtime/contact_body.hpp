#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/contact/tool.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/local_model.hpp"
#include "runtime/loop.hpp"
#include "runtime/model.hpp"
#include "runtime/surface.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

struct TouchedBody;  // what a contact body keeps in its memory: runtime/contact_body/touched_body.hpp

/// An elastic body that rigid tools touch: where they do, unilaterally and with friction, which forces and torques they
/// feel, and how the surface is deformed (James & Pai 2001, section 6; docs/touching.md). It has an `Elastostatic` of
/// its own. Places are in the frame of the model.
class ContactBody {
 public:
  struct Limits {
    Elastostatic::Limits elastostatic{};  ///< max_contacts: at most 256, the corners of triangles count each;
                                          ///< iterations above 0; forces_only false
    std::uint32_t max_tools = 2;          ///< 1..16
    std::uint32_t max_points = 8;         ///< of a tool that are followed, 1..128: Shape::point_count
    double margin = 0;              ///< m, how near the surface is looked at: 0 is a quarter of its mean edge length
    double rigid_stiffness = 0;     ///< N/m, of places that cannot move; 0: what the model's material has over 1 mm
    std::uint64_t search_work = 0;  ///< units that looking for contacts may take: 0 is what suffices for max_contacts
                                    ///< of them and tools that do not leap, of no more than about ten faces
    bool carried = false;           ///< whether the surface may be carried: `carry`
  };

  /// One step's tool.
  struct ToolInput {
    Tool tool;              ///< shape and pose
    double friction = 0.3;  ///< Coulomb's coefficient, 0 or more; above 1,000 as 1,000
    double compliance = 0;  ///< m/N, of a spring between the pose and the tool, which does not turn, 0 or more: a
                            ///< virtual coupling (runtime/passivity.hpp); 0: the tool is at its pose
  };

  /// What a tool feels.
  struct ToolAnswer {
    ToolFault fault = ToolFault::none;  ///< with one the tool is left out
    Double3 force;                      ///< N, on the tool
    Double3 torque;                     ///< N m, on the tool about its origin: its pose's position and sag
    std::uint32_t first_contact = 0;    ///< among contacts()
    std::uint32_t contacts = 0;         ///< places that may touch, of which those with a force do
    double depth = 0;                   ///< m, how far the tool was inside of the surface before this step's answer
    bool is_behind = false;             ///< a point of it that is followed (Shape::point) was behind the surface then
    Double3 sag;                        ///< m, how far its spring (ToolInput::compliance) lets it be from its pose
  };

  /// A place of the surface that may touch a tool.
  struct Contact {
    std::uint32_t node[3] = {};  ///< file indices; those after the first are layout::none unless it lies in a triangle
    double weight[3] = {};
    std::uint32_t tool = 0;
    ContactState state = ContactState::open;
    Double3 position;  ///< m, of the surface, displaced
    Double3 normal;    ///< unit, out of the tool
    Double3 force;     ///< N, on the body
    double gap = 0;    ///< m, from the tool along the normal
    Double3 slip;      ///< m, along the tool's surface in this step
  };

  /// J, of all steps so far, by the forces at the end of each: in + from_loads = stored + dissipated + lost, but for
  /// what is generated.
  struct Energy {
    double in = 0;          ///< work of the tools on the body while they touch
    double stored = 0;      ///< what the contacts' forces strain the body with
    double dissipated = 0;  ///< by friction
    double lost = 0;        ///< by going in steps: never negative where the laws of contact hold
    double generated = 0;   ///< the most that did not add up: rounding, and answers short of budget
    double from_loads = 0;  ///< what loads that change put in at the contacts; < 0: took out
  };

  /// What Limits cost. least_work: with that budget every step is answered, its contacts found and held at least at the
  /// coarsest level.
  struct Requirement : greenloop::Requirement {
    std::uint64_t worst_work = 0;     ///< of a step that is answered at the finest level
    std::uint64_t touching_work = 0;  ///< of finding contacts, at most: a part of both
  };

  /// A place of the surface that a tool comes near.
  struct Place {
    std::uint32_t tool = layout::none;
    std::uint32_t node[3] = {layout::none, layout::none, layout::none};  ///< as of a Contact
    double weight[3] = {};
  };

  struct StepReport : Elastostatic::UnilateralReport {
    std::uint64_t touching_work = 0;  ///< units of `work` that finding what touches took
    std::uint32_t left_out = 0;       ///< places that may touch, but for which there was no room: the deepest were kept
    double deepest_left_out = 0;      ///< m, depth of the deepest of these, negative if not inside of a tool
    Place left_out_place;             ///< which is there; none: nothing was left out
    std::uint32_t unfinished = 0;     ///< tools that search_work did not suffice for: what is nearest was looked at
  };

  struct Created;

  /// Bytes and work for some limits; tools of more than max_points points are left out. Start-up; as
  /// Elastostatic::required. Zero bytes if `create` would refuse for another reason than memory.
  [[nodiscard]] static Requirement required(const Model& model, const Limits& limits) noexcept;

  /// Carves `memory` with the routine that `required` counts with. The model's bytes and `memory` must outlive it.
  /// Start-up.
  [[nodiscard]] static Created create(const Model& model, const Limits& limits, std::span<std::byte> memory) noexcept;

  /// One cycle of the loop: finds what may touch the tools, continuously in their motion since the last step, and the
  /// forces of contact. A tool is known from step to step by its place among them; those beyond max_tools are refused:
  /// held_out_of_range. No heap, lock, system call, exception or clock; the same model, limits, tools, history and
  /// budget give the same bits. Budgets from Requirement::least_work on are enough: what they do not hold is answered
  /// coarser, each force pushing and within its cone of friction. On a `held_` status the last answer stands;
  /// held_not_finite and held_bad_surface are said of a tool's friction, held_over_budget at zero work.
  /// Work: at most budget.work.
  StepReport step(std::span<const ToolInput> tools, const Elastostatic::Loads& loads, Budget budget) noexcept;

  /// Units that finding what may touch these tools takes at most, wherever they are: no more than
  /// Requirement::touching_work. For the loop; work: the tools.
  [[nodiscard]] std::uint64_t touching_work(std::span<const ToolInput> tools) const noexcept;

  // The last answer, until the next step; empty or at rest before the first. For the loop; constant work.
  [[nodiscard]] std::span<const ToolAnswer> tools() const noexcept;   ///< [tools] in their order
  [[nodiscard]] std::span<const Contact> contacts() const noexcept;   ///< by tool
  [[nodiscard]] std::span<const Vec4> displacement() const noexcept;  ///< [nodes] m, x y z 0
  [[nodiscard]] const Energy& energy() const noexcept;

  /// m^2, of the surface at rest that a contact stands for: the areas of its nodes (Surface::areas) by its weights. Its
  /// force over that is the traction there. Nodes that the model does not have count nothing. For the loop; constant
  /// work.
  [[nodiscard]] double area(const Contact& contact) const noexcept;

  /// The tool is somewhere else without having been between: in the next step it is placed where it is, and holds on to
  /// nothing. Numbers that no tool has are ignored. For the loop; work: linear in the contacts.
  void forget(std::uint32_t tool) noexcept;

  /// Factors on the tools' coefficients of friction, [nodes], 0 or more: of a place within a triangle by the weights of
  /// its corners. They are read in every step until the next call; the memory is the caller's, who may change them
  /// between steps. Empty: 1 everywhere; ignored if there are not as many as nodes. One that is negative or not finite
  /// is refused by the steps in which a tool may touch there, as a tool's own. For the loop; constant work.
  void surface_friction(std::span<const float> factor) noexcept;

  /// The surface at rest moves by itself: to where the model has it and `offset`, [nodes] m, x y z 0. Tools touch it
  /// there, and what it moves by between two steps is motion against them, as their own is. It is read in every step
  /// until the next call; the memory is the caller's, who may change it between steps. Empty: it stands still again.
  /// False, and nothing changes: there are not as many as nodes, or Limits::carried is false. Steps with one that is
  /// not finite are refused: held_not_finite. For the loop; constant work.
  bool carry(std::span<const Vec4> offset) noexcept;

  /// The surface at rest, of the finest level; in the body's memory. Constant work.
  [[nodiscard]] const Surface& surface() const noexcept;

  /// How the tools' forces and torques follow their poses between this step and the next (docs/touching.md, "A faster
  /// loop"). turns: false: poses do not turn meanwhile, which is half of the work. length: m, above 0, what a turn
  /// counts as. Returns the work units that it took, at most local_model_work; 0, and nothing is written: refused,
  /// before the first answer, after a step that was refused, without a tool or with more than LocalModel::most_tools,
  /// or if length is not above 0. For the loop.
  std::uint64_t local_model(bool turns, float length, LocalModel& model) noexcept;

  /// Work units of `local_model` for so many tools. For the loop; constant work.
  [[nodiscard]] std::uint64_t local_model_work(std::uint32_t tools, bool turns) const noexcept;

 private:
  TouchedBody* body_ = nullptr;
};

struct ContactBody::Created : Creation {
  ContactBody body;
};

}  // namespace greenloop
