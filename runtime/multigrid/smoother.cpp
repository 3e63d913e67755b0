#include "runtime/multigrid/smoother.hpp"

namespace greenloop {

void sweep_from_zero(const MultigridLevel& level, std::span<const Float4> b, std::span<Float4> x) noexcept {
  for (std::uint32_t v = 0; v < level.vertices(); ++v) {
    Float4 rest = b[v];
    for (std::uint32_t k = level.start[v]; k < level.upper[v]; ++k) {
      rest -= product(level.block[k], x[level.column[k]]);
    }
    x[v] = product(level.inverse[v], rest);
  }
}

void sweep_backwards(const MultigridLevel& level, std::span<const Float4> b, std::span<Float4> x) noexcept {
  for (std::uint32_t v = level.vertices(); v-- > 0;) {
    Float4 rest = b[v];
    for (std::uint32_t k = level.start[v]; k < level.start[v + 1]; ++k) {
      rest -= product(level.block[k], x[level.column[k]]);
    }
    x[v] = product(level.inverse[v], rest);
  }
}

}  // namespace greenloop
