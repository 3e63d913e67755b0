#include "runtime/wavelet/refinement.hpp"

#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

void list_parents(const ModelView& view, DomainParents* parents) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& at = view.level[q];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      for (std::uint32_t side = 0; side < 2; ++side) {
        const std::uint32_t parent = q == 0 ? layout::none : at.refinement[i].parent[side];
        const bool stored = q > 0 && in_domain(view, parent);
        parents[at.domain_begin + i].place[side] = stored ? domain_place(view, parent) : layout::none;
      }
    }
  }
}

void list_stencils(const ModelView& view, DomainStencil* stencils) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& at = view.level[q];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      for (std::uint32_t k = 0; k < 6; ++k) {
        const std::uint32_t node = at.stencils == nullptr ? layout::none
                                   : k < 2                ? at.stencils[i].wing[k]
                                                          : at.stencils[i].outer[k - 2];
        const bool stored = node != layout::none && in_domain(view, node);
        stencils[at.domain_begin + i].place[k] = stored ? domain_place(view, node) : layout::none;
      }
    }
  }
}

}  // namespace

void RefinementTables::carve(Arena& arena, const ModelView& view) noexcept {
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    begin_[q] = arena.take<std::uint32_t>(domain_up_to(view, q - 1) + std::uint64_t{1});
    neighbours_[q] = arena.take<OddNeighbours>(count_lifting(view, q).records);
  }
  if (!prediction_of(view).blocks) {
    parents_ = arena.take<DomainParents>(view.domain_count);
  }
  if (layout::is_butterfly(static_cast<layout::Wavelet>(view.info->wavelet))) {
    stencils_ = arena.take<DomainStencil>(view.domain_count);
  }
  level_ = arena.take<std::uint8_t>(view.domain_count);
}

void RefinementTables::fill(const ModelView& view) noexcept {
  if (parents_ != nullptr) {
    list_parents(view, parents_);
  }
  if (stencils_ != nullptr) {
    list_stencils(view, stencils_);
  }
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    list_odd_neighbours(view, q, begin_[q], neighbours_[q]);
  }
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& at = view.level[q];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      level_[at.domain_begin + i] = static_cast<std::uint8_t>(q);
    }
  }
}

Refinement RefinementTables::refinement(const ModelView& view, Lifting& lifting) const noexcept {
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    lifting.begin[q] = begin_[q];
    lifting.neighbours[q] = neighbours_[q];
  }
  return {&view, &lifting, prediction_of(view), parents_, stencils_, level_};
}

}  // namespace greenloop
