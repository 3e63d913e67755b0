#pragma once

#include <cstdint>
#include <span>

#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/step_work.hpp"

namespace greenloop {

/// What a step asks for.
struct Wants {
  std::uint64_t budget = 0;
  bool field = false;
  std::uint32_t finest_displaced = 0;  ///< level of the nodes that are displaced
  bool keeps_level = false;            ///< new contacts, then details of the field go before the finest level does
  std::uint32_t corners = 0;           ///< as of SetCounts
  std::uint32_t iterations = 0;
  std::uint32_t rows = 0;
};

/// How a step will be answered. Its contacts are resolved in body.planned, whose coefficients are touched if a field is
/// wanted or nodes enter its factor.
struct Plan {
  std::uint32_t level = 0;
  SetCounts counts;
  Factor* cached = nullptr;
  bool update = false;          ///< of another factor, by body.changes; else a fresh one is made
  std::uint64_t forces = 0;     ///< work of the forces, given the factor
  std::uint64_t factor = 0;     ///< bound of the work of the factor, unless it is cached
  std::uint64_t bounded = 0;    ///< the part of it that is not known before, but counted where it is done
  std::uint64_t displaced = 0;  ///< bound of the work of what the loads displace of the contacts
  FieldLevels field_levels;
  std::uint64_t work = 0;     ///< spent on deciding
  std::uint64_t field = 0;    ///< work of the field
  std::uint64_t reserve = 0;  ///< what the budget has to hold besides, of a step in which contacts wait
  bool fits = false;

  /// The finest level that nothing but its factor kept from answering.
  struct Wanted {
    bool exists = false;
    std::uint32_t level = 0;
    SetCounts counts;
  } wanted;
};

/// Work units of planning a set whose factor is not cached.
[[nodiscard]] std::uint64_t plan_set_work(const ModelCounts& model, const SetCounts& set) noexcept;

/// Work units of planning the part of a set that a factor at hand has, after the set; of one level in a step.
[[nodiscard]] std::uint64_t plan_part_work(const ModelCounts& model, const SetCounts& set) noexcept;

/// Chooses by closed-form work the finest level whose answer fits, with the field as it was asked for: by its cached
/// factor, an update of another one or a fresh one. Where only the factor of the finest level is too dear, contacts
/// that are new may wait, and the others be answered there by what a factor at hand has of them; where the level
/// is kept, the field then goes without details before a coarser one is tried. If no level fits, the coarsest with as
/// many details in the field as fit. For the loop; work: Plan::work.
[[nodiscard]] Plan make_plan(Body& body, std::span<const Constraint> contacts, const Wants& wants) noexcept;

}  // namespace greenloop
