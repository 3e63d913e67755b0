#include "runtime/multigrid/transfer.hpp"

namespace greenloop {

void restrict_residual(const MultigridLevel& fine, std::span<const Float4> x, std::span<Float4> coarse) noexcept {
  for (Float4& sum : coarse) sum = Float4{};
  for (std::uint32_t v = 0; v < fine.vertices(); ++v) {
    Float4 residual{};
    for (std::uint32_t k = fine.upper[v]; k < fine.start[v + 1]; ++k) {
      residual -= product(fine.block[k], x[fine.column[k]]);
    }
    for (std::uint32_t k = fine.parent_start[v]; k < fine.parent_start[v + 1]; ++k) {
      coarse[fine.parent[k]] += scaled(fine.weight[k], residual);
    }
  }
}

void add_prolonged(const MultigridLevel& fine, std::span<const Float4> coarse, std::span<Float4> x) noexcept {
  for (std::uint32_t v = 0; v < fine.vertices(); ++v) {
    Float4 sum = x[v];
    for (std::uint32_t k = fine.parent_start[v]; k < fine.parent_start[v + 1]; ++k) {
      sum += scaled(fine.weight[k], coarse[fine.parent[k]]);
    }
    x[v] = sum;
  }
}

}  // namespace greenloop
