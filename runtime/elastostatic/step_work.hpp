#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/compliance/base_columns.hpp"
#include "runtime/compliance/column_bounds.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/factor/factor_work.hpp"
#include "runtime/wavelet/point_support.hpp"

namespace greenloop {

/// Counts of a model and its limits that the work of a step follows from.
struct ModelCounts : FactorCounts {
  std::uint32_t levels = 0;
  std::uint32_t max_contacts = 0;
  std::uint32_t glide_cycles = 1;
  std::uint32_t iterations = 0;
  bool forces_only = false;
  bool mixed_contacts = false;
  std::uint32_t max_forces = 0;   ///< known ones
  std::uint32_t model_loads = 0;  ///< that may act
  std::uint32_t max_points = 0;   ///< of selected answers
  std::uint64_t refining_work = 0;
  std::uint64_t nodes[layout::max_levels] = {};  ///< of levels 0..F
  std::uint64_t rows[layout::max_levels] = {};   ///< coefficients of levels 0..F

  /// Whether anything but contacts may act.
  [[nodiscard]] bool takes_loads() const noexcept { return max_forces > 0 || model_loads > 0; }
};

/// What acts on a body beside its contacts.
struct LoadCounts {
  SetCounts forces;              ///< known ones; `columns` are as many as there are, whether they are distinct or not
  std::uint64_t amounts = 0;     ///< loads of the model
  std::uint64_t set_stored = 0;  ///< blocks in the columns of the contacts' coefficients
};

/// Work units of resolving contacts at a level, counting the blocks of their field and asking the cache.
[[nodiscard]] std::uint64_t resolve_work(const ModelCounts& model, const SetCounts& set) noexcept;

/// Work units of solving for the forces of a set with its factor.
[[nodiscard]] std::uint64_t solve_work(const Prices& prices, std::uint64_t contacts, std::uint64_t columns) noexcept;

/// Bound of the work units of the forces of the level before, if their factor is cached.
[[nodiscard]] std::uint64_t older_forces_work(const ModelCounts& model, std::uint64_t contacts) noexcept;

/// Iterations over unilateral contacts that an answer has at least, of so many that it may have.
constexpr std::uint32_t least_iterations(std::uint32_t iterations) { return iterations < 8 ? iterations : 8; }

/// Work units of the forces, given the factor, and of their glide.
[[nodiscard]] std::uint64_t force_work(const Prices& prices, const SetCounts& set) noexcept;

/// Work units of resolving known forces, finding what they touch, and counting the blocks of that and of a set.
[[nodiscard]] std::uint64_t plan_loads_work(const ModelCounts& model, const SetCounts& set,
                                            const LoadCounts& loads) noexcept;

/// Bound of the blocks that couple known forces and a set.
[[nodiscard]] std::uint64_t most_coupling_blocks(const SetCounts& set, const LoadCounts& loads) noexcept;

/// Work units of the displacement of a set's columns by loads, of which so many blocks are between the two.
[[nodiscard]] std::uint64_t displace_by_loads_work(const ModelCounts& model, const SetCounts& set,
                                                   const LoadCounts& loads, std::uint64_t between) noexcept;

/// Work units of touching what points depend on and forces reach, before what they displace.
[[nodiscard]] std::uint64_t ask_work(const ModelCounts& model, const SetCounts& points,
                                     const LoadCounts& loads) noexcept;

/// Work units of the loads' part of a field, with details up to a level, that sums `blocks` blocks.
[[nodiscard]] std::uint64_t load_field_work(const ModelCounts& model, const LoadCounts& loads, std::uint32_t details,
                                            std::uint64_t blocks) noexcept;

/// Work units of the field of a body at rest.
constexpr std::uint64_t rest_field_work(const Prices& prices, std::uint64_t nodes) {
  return priced(1, prices.resting_field) + priced(nodes, prices.resting_node);
}

/// Work units of a field that sums `blocks` blocks.
[[nodiscard]] std::uint64_t field_work(const ModelCounts& model, const SetCounts& set, const FieldLevels& levels,
                                       std::uint64_t blocks) noexcept;

/// Blocks that the field of forces on touched coefficients sums with details up to `field_level`. For the loop; work:
/// one unit per coefficient.
[[nodiscard]] std::uint64_t count_field_blocks(const FieldBlocks& blocks, const Touched& touched,
                                               std::uint32_t field_level) noexcept;

/// Bounds of the counts of any set of contacts at a constraint level.
struct MostCounts {
  SetCounts set;
  std::uint64_t touched[layout::max_levels] = {};  ///< coefficients of each level
  std::uint64_t field_blocks = 0;                  ///< of count_field_blocks, of the whole field
  std::uint64_t least_field_blocks = 0;            ///< the same with the coarsest details alone
};

/// Stored blocks in the columns of touched coefficients. stored: [domain]. For the loop; work: a unit a coefficient.
[[nodiscard]] std::uint64_t count_stored(const std::uint32_t* stored, const Touched& touched) noexcept;

/// Of at most `max_contacts` contacts at constraint level c, but for their blocks. lifting: of every level. Start-up.
[[nodiscard]] MostCounts most_counts(const ModelView& view, std::uint32_t c, std::uint32_t max_contacts,
                                     const ColumnBounds& bounds, const LiftingCounts* lifting) noexcept;

/// Of known forces on at most model.max_forces nodes, as many as may be touched, but for their blocks. Start-up.
[[nodiscard]] MostCounts most_force_counts(const ModelView& view, std::uint32_t c, const ModelCounts& model,
                                           const ColumnBounds& bounds, const LiftingCounts* lifting) noexcept;

/// Of columns of the finest level, any of the domain. reach: of that level. Start-up; linear in the domain.
[[nodiscard]] SetCounts most_point_counts(const ModelView& view, std::uint64_t columns, const ReachBound& reach,
                                          const LiftingCounts* lifting) noexcept;

/// Adds the blocks of the coefficients that sets touch, of constraint levels coarsest..finest: as many of each level's
/// longest lists as a set touches there. most_of: by constraint level. Start-up; work: that of count_blocks, twice a
/// level.
void add_blocks(const ModelView& view, const BaseColumns& base, MostCounts* most_of) noexcept;

}  // namespace greenloop
