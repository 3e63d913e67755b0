#include "runtime/multigrid/cycle.hpp"

#include "runtime/multigrid/coarsest.hpp"
#include "runtime/multigrid/smoother.hpp"
#include "runtime/multigrid/transfer.hpp"

namespace greenloop {

void v_cycle(const MultigridCycle& cycle) noexcept {
  const auto& [levels, coarsest, fields, scratch] = cycle;
  const std::size_t last = levels.size();
  for (std::size_t l = 0; l < last; ++l) {
    sweep_from_zero(levels[l], fields[l].b, fields[l].x);
    restrict_residual(levels[l], fields[l].x, fields[l + 1].b);
  }
  solve_coarsest(coarsest, fields[last].b, scratch, fields[last].x);
  for (std::size_t l = last; l-- > 0;) {
    add_prolonged(levels[l], fields[l + 1].x, fields[l].x);
    sweep_backwards(levels[l], fields[l].b, fields[l].x);
  }
}

}  // namespace greenloop
