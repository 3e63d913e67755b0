#include "runtime/compliance/field.hpp"

#include <algorithm>
#include <cstddef>

#include "runtime/compliance/couplings.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// the blocks of a column in rows before `end`
BlockRange blocks_before(const CouplingsView& couplings, std::uint32_t column, std::uint32_t end) {
  if (couplings.columns == 0) {
    return {&couplings, 0, 0};
  }
  const std::uint32_t first = couplings.begin[column];
  const std::uint32_t last = couplings.begin[column + 1];
  const auto count_before = [&](const auto* row) {
    return static_cast<std::uint32_t>(std::lower_bound(row + first, row + last, end) - row);
  };
  return {&couplings, first,
          couplings.index_bytes == 2 ? count_before(static_cast<const std::uint16_t*>(couplings.index))
                                     : count_before(static_cast<const std::uint32_t*>(couplings.index))};
}

// all of them
BlockRange blocks_of(const CouplingsView& couplings, std::uint32_t column) {
  return couplings.columns == 0 ? BlockRange{&couplings, 0, 0}
                                : BlockRange{&couplings, couplings.begin[column], couplings.begin[column + 1]};
}

// what a force coefficient moves, up to the coefficients before `end`
template <unsigned N>
class CoefficientColumn {
 public:
  CoefficientColumn(const FieldModel<N>& model, std::uint32_t coefficient, std::uint32_t end)
      : model_(model),
        level_(model.refinement.view->level[model.refinement.level[coefficient]]),
        coefficient_(coefficient),
        end_(end) {}

  void add(Vector<N> force, const CoefficientSums<N>& sums) const {
    const layout::Info& info = *model_.refinement.view->info;
    const std::uint32_t own = coefficient_ - level_.domain_begin;
    const Vector<N> scaled_force = symmetric_product(level_.scales_of<N>()[own].root, force);
    if (coefficient_ < end_) {
      Vector<N>& sum = sums.of_blocks[coefficient_];
      sum = added(sum, symmetric_product(level_.scales_of<N>()[own].diagonal, without_denormals(scaled_force)));
    }
    if (coefficient_ < model_.base.columns) {
      model_.add_tiles(model_.base.template column<N>(coefficient_), tiles_of(end_),
                       without_denormals(scaled(info.quantum[BaseColumns::quantum_layer], scaled_force)),
                       sums.of_tiles);
    }
    const bool whole = end_ == model_.refinement.view->domain_count;
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& mirrored = model_.mirrored.layer[layer];
      const BlockRange before = coefficient_ < end_ ? blocks_of(level_.couplings[layer], own)
                                                    : blocks_before(level_.couplings[layer], own, end_);
      const BlockRange after = whole ? blocks_of(mirrored, coefficient_) : blocks_before(mirrored, coefficient_, end_);
      if (before.begin == before.end && after.begin == after.end) {
        continue;
      }
      const Vector<N> in_quanta = without_denormals(scaled(block_factor<N>(info, layer), scaled_force));
      model_.sums.add[layer](before, in_quanta, sums.of_blocks);
      model_.sums.add[layer](after, in_quanta, sums.of_blocks);
    }
  }

 private:
  const FieldModel<N>& model_;
  const LevelView& level_;
  std::uint32_t coefficient_;
  std::uint32_t end_;
};

// the sums of four coefficients of a tile, as one vector each
void add_four(const TileSums<3>& tile, std::size_t half, Float4* sums) {
  const Float4 x = tile.of[0][half];
  const Float4 y = tile.of[1][half];
  const Float4 z = tile.of[2][half];
  const Float4 xy_low = __builtin_shufflevector(x, y, 0, 4, 1, 5);
  const Float4 xy_high = __builtin_shufflevector(x, y, 2, 6, 3, 7);
  const Float4 z_low = __builtin_shufflevector(z, Float4{}, 0, 4, 1, 5);
  const Float4 z_high = __builtin_shufflevector(z, Float4{}, 2, 6, 3, 7);
  sums[0] = added(sums[0], __builtin_shufflevector(xy_low, z_low, 0, 1, 4, 5));
  sums[1] = added(sums[1], __builtin_shufflevector(xy_low, z_low, 2, 3, 6, 7));
  sums[2] = added(sums[2], __builtin_shufflevector(xy_high, z_high, 0, 1, 4, 5));
  sums[3] = added(sums[3], __builtin_shufflevector(xy_high, z_high, 2, 3, 6, 7));
}

void add_four(const TileSums<1>& tile, std::size_t half, float* sums) {
  for (std::size_t k = 0; k < 4; ++k) {
    sums[k] += tile.of[0][half][k];
  }
}

// moves the sums of tiles to those of blocks
template <unsigned N>
void add_tile_sums(std::uint32_t end, const CoefficientSums<N>& sums) {
  for (std::uint32_t t = 0; t < tiles_of(end); ++t) {
    Vector<N>* const of_blocks = sums.of_blocks + std::size_t{BaseColumns::width} * t;
    add_four(sums.of_tiles[t], 0, of_blocks);
    add_four(sums.of_tiles[t], 1, of_blocks + 4);
    sums.of_tiles[t] = {};
  }
  for (std::uint32_t i = end; i < BaseColumns::width * tiles_of(end); ++i) {
    sums.of_blocks[i] = Vector<N>{};  // of a tile that a field is cut in
  }
}

}  // namespace

template <unsigned N>
void count_field_blocks(const ModelView& view, const MirroredCouplings& mirrored, const BaseColumns& base,
                        std::uint32_t* up_to) noexcept {
  for (std::uint32_t own = 0; own < view.levels; ++own) {
    const LevelView& level = view.level[own];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (std::uint32_t q = 0; q < view.levels; ++q, ++up_to) {
        const std::uint32_t end = domain_up_to(view, q);
        *up_to = level.domain_begin + i < end ? 1 : 0;
        *up_to += level.domain_begin + i < base.columns ? FieldBlocks::of_tile<N> * tiles_of(end) : 0;
        for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
          for (const BlockRange& range : {blocks_before(level.couplings[layer], i, end),
                                          blocks_before(mirrored.layer[layer], level.domain_begin + i, end)}) {
            *up_to += range.end - range.begin;
          }
        }
      }
    }
  }
}

template <unsigned N>
void scale_sums(const ModelView& view, std::uint32_t end, const CoefficientSums<N>& sums) noexcept {
  if (sums.of_tiles != nullptr) {
    add_tile_sums(end, sums);
  }
  for (std::uint32_t q = 0; q < view.levels && view.level[q].domain_begin < end; ++q) {
    const LevelView& level = view.level[q];
    Vector<N>* const sum = sums.of_blocks + level.domain_begin;
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      sum[i] = symmetric_product(level.scales_of<N>()[i].root, sum[i]);
    }
  }
}

template <unsigned N>
void sum_couplings(const FieldModel<N>& model, const Touched& touched, std::uint32_t end, Vector<N>* force,
                   const CoefficientSums<N>& sums) noexcept {
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t coefficient = touched.list[q][k];
      CoefficientColumn<N>(model, coefficient, end).add(force[coefficient], sums);
      force[coefficient] = Vector<N>{};
    }
  }
}

template <unsigned N>
void sum_forces(const FieldModel<N>& model, const ColumnForces& forces, const Touched& touched, std::uint32_t end,
                const FieldScratch<N>& scratch) noexcept {
  transform_forces<N>(model.refinement, forces, touched, scratch.force);
  sum_couplings<N>(model, touched, end, scratch.force, scratch.sums);
}

template <unsigned N>
void compute_field(const FieldModel<N>& model, const ColumnForces& forces, const Touched& touched,
                   const FieldLevels& levels, const FieldScratch<N>& scratch, Vector<N>* x,
                   const ActingLoads& loads) noexcept {
  const ModelView& view = *model.refinement.view;
  sum_forces<N>(model, forces, touched, domain_up_to(view, levels.details), scratch);
  scale_sums(view, domain_up_to(view, levels.details), scratch.sums);
  if constexpr (N == 3) {
    add_loads(view, loads, levels.details, scratch.sums.of_blocks);
  }
  inverse_transform<N>(view, model.offsets, levels, scratch.sums.of_blocks, x);
}

template void count_field_blocks<1>(const ModelView&, const MirroredCouplings&, const BaseColumns&,
                                    std::uint32_t*) noexcept;
template void count_field_blocks<3>(const ModelView&, const MirroredCouplings&, const BaseColumns&,
                                    std::uint32_t*) noexcept;
template void scale_sums<1>(const ModelView&, std::uint32_t, const CoefficientSums<1>&) noexcept;
template void scale_sums<3>(const ModelView&, std::uint32_t, const CoefficientSums<3>&) noexcept;
template void sum_couplings<1>(const FieldModel<1>&, const Touched&, std::uint32_t, Vector<1>*,
                               const CoefficientSums<1>&) noexcept;
template void sum_couplings<3>(const FieldModel<3>&, const Touched&, std::uint32_t, Vector<3>*,
                               const CoefficientSums<3>&) noexcept;
template void sum_forces<1>(const FieldModel<1>&, const ColumnForces&, const Touched&, std::uint32_t,
                            const FieldScratch<1>&) noexcept;
template void sum_forces<3>(const FieldModel<3>&, const ColumnForces&, const Touched&, std::uint32_t,
                            const FieldScratch<3>&) noexcept;
template void compute_field<1>(const FieldModel<1>&, const ColumnForces&, const Touched&, const FieldLevels&,
                               const FieldScratch<1>&, Vector<1>*, const ActingLoads&) noexcept;
template void compute_field<3>(const FieldModel<3>&, const ColumnForces&, const Touched&, const FieldLevels&,
                               const FieldScratch<3>&, Vector<3>*, const ActingLoads&) noexcept;

}  // namespace greenloop
