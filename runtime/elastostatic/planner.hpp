#pragma once

#include <cstdint>
#include <span>

#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/step_work.hpp"

namespace greenloop {

/// How a step will be answered. Its contacts are resolved in body.planned, whose coefficients are touched unless its
/// factor is cached and no field is wanted.
struct Plan {
  Resolution resolution;
  SetCounts counts;
  Factor* cached = nullptr;
  bool update = false;        ///< of another factor, by body.changes; else a fresh one is made
  std::uint64_t factor = 0;   ///< bound of the work of the factor, unless it is cached
  std::uint64_t bounded = 0;  ///< the part of it that is not known before, but counted where it is done
  FieldLevels field_levels;
  std::uint64_t work = 0;   ///< spent on deciding
  std::uint64_t field = 0;  ///< work of the field
  bool fits = false;

  /// The finest level that nothing but its factor kept from answering.
  struct Wanted {
    bool exists = false;
    std::uint32_t level = 0;
    SetCounts counts;
    std::uint64_t field = 0;  ///< work of its field
  } wanted;
};

/// Work units of planning a set whose factor is not cached.
[[nodiscard]] std::uint64_t plan_set_work(const ModelCounts& model, const SetCounts& set) noexcept;

/// Bound of the work units of the factor of a mixed set, which is a cached one or differs from one by
/// FactorChanges::most nodes.
[[nodiscard]] std::uint64_t most_change_work(const ModelCounts& model, const SetCounts& most) noexcept;

/// Work units of planning a mixed set of such counts.
[[nodiscard]] std::uint64_t mixture_work(const ModelCounts& model, const SetCounts& set) noexcept;

/// Chooses by closed-form work the finest level whose answer fits, with the field as it was asked for: by its cached
/// factor, an update of another one or a fresh one. Where only the factor of the finest level is too dear, groups of
/// contacts of the level that fits are put there, as many as a factor at hand can take (Mixture). If no level fits, the
/// coarsest with as many details in the field as fit. finest_displaced: level of the nodes that are displaced. For the
/// loop; work: Plan::work.
[[nodiscard]] Plan make_plan(Body& body, std::span<const Constraint> contacts, std::uint64_t budget, bool wants_field,
                             std::uint32_t finest_displaced) noexcept;

}  // namespace greenloop
