#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/contact_set.hpp"

namespace greenloop {

/// Counts of a model and its limits that the work of a step follows from.
struct ModelCounts {
  std::uint64_t nodes = 0;
  std::uint32_t levels = 0;
  std::uint32_t max_contacts = 0;
  std::uint32_t cached_factors = 0;
  std::uint64_t transform_work[layout::max_levels] = {};  ///< of an inverse transform with details up to a level
};

/// What a set of columns of one constraint level holds.
struct SetCounts {
  std::uint64_t contacts = 0;
  std::uint64_t columns = 0;
  std::uint64_t coefficients = 0;                 ///< over the point functionals of all columns
  std::uint64_t blocks[layout::max_levels] = {};  ///< over all columns, in the rows of levels 0..r
};

/// Work units of deciding whether to resolve `contacts` at a level: merging, sorting, counting, asking the cache.
[[nodiscard]] std::uint64_t plan_work(const ModelCounts& model, std::uint64_t contacts, std::uint64_t columns) noexcept;

/// Work units of a capacitance factor.
[[nodiscard]] std::uint64_t factor_work(const ModelCounts& model, const SetCounts& set) noexcept;

/// Work units of the forces, given the factor.
[[nodiscard]] std::uint64_t force_work(const SetCounts& set) noexcept;

/// Work units of the field with details up to `field_level`.
[[nodiscard]] std::uint64_t field_work(const ModelCounts& model, const SetCounts& set,
                                       std::uint32_t field_level) noexcept;

/// Counts of a resolved set. functional_size: [columns of set.level] coefficients of each column's point functional.
[[nodiscard]] SetCounts count_set(const ModelView& view, const ContactSet& set, std::uint64_t contacts,
                                  const std::uint32_t* functional_size) noexcept;

/// Bounds of the counts of any set of at most `max_contacts` contacts at a constraint level. functional_bound: largest
/// point functional of that level. Start-up; 33 passes over the level's columns for every mesh level.
[[nodiscard]] SetCounts most_counts(const ModelView& view, std::uint32_t constraint_level, std::uint32_t max_contacts,
                                    std::uint32_t functional_bound) noexcept;

}  // namespace greenloop
