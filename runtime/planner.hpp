#pragma once

#include <cstdint>
#include <span>

#include "runtime/body.hpp"
#include "runtime/factor_update.hpp"
#include "runtime/plan.hpp"

namespace greenloop {

/// How a step will be answered. Its contacts are resolved in body.set, whose coefficients are touched unless its factor
/// is cached.
struct Plan {
  Resolution resolution;
  SetCounts counts;
  Factor* cached = nullptr;
  FactorChanges changes;     ///< base: the factor to update, or null: make a fresh one
  std::uint64_t factor = 0;  ///< work of the factor, unless it is cached
  FieldLevels field_levels;
  std::uint64_t work = 0;   ///< spent on deciding
  std::uint64_t field = 0;  ///< work of the field
  bool fits = false;

  /// The best set that nothing but its factor kept from answering.
  struct Wanted {
    bool exists = false;
    Resolution resolution;
    SetCounts counts;
  } wanted;
};

/// Bound of the work units of planning a mixed set of `most` counts.
[[nodiscard]] std::uint64_t mixture_work(const ModelCounts& model, const SetCounts& most) noexcept;

/// Chooses by closed-form work, in this order: every contact at the finest level; the finest level that fits with a
/// factor at hand, with as many groups of contacts at the finest level as fit then; coarser levels; the coarsest with a
/// field of fewer details. Of each set: its cached factor, an update of another one, a fresh one. finest: level of the
/// nodes that are displaced. For the loop; Plan::work.
[[nodiscard]] Plan make_plan(Body& body, std::span<const Contact> contacts, std::uint64_t budget, bool wants_field,
                             std::uint32_t finest) noexcept;

}  // namespace greenloop
