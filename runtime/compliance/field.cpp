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
class CoefficientColumn {
 public:
  CoefficientColumn(const FieldModel& model, std::uint32_t coefficient, std::uint32_t end)
      : model_(model),
        level_(model.refinement.view->level[model.refinement.level[coefficient]]),
        coefficient_(coefficient),
        end_(end) {}

  void add(Float4 force, const CoefficientSums& sums) const {
    const layout::Info& info = *model_.refinement.view->info;
    const std::uint32_t own = coefficient_ - level_.domain_begin;
    const Float4 scaled = symmetric_product(level_.scales_of<3>()[own].root, force);
    if (coefficient_ < end_) {
      Float4& sum = sums.of_blocks[coefficient_];
      sum = sum3(sum, symmetric_product(level_.scales_of<3>()[own].diagonal, without_denormals(scaled)));
    }
    if (coefficient_ < model_.base.columns) {
      model_.add_tiles(model_.base.column(coefficient_), tiles_of(end_),
                       without_denormals(splat(info.quantum[BaseColumns::quantum_layer]) * scaled), sums.of_tiles);
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
      const Float4 in_quanta = without_denormals(splat(block_factor(info, layer)) * scaled);
      model_.sums.add[layer](before, in_quanta, sums.of_blocks);
      model_.sums.add[layer](after, in_quanta, sums.of_blocks);
    }
  }

 private:
  const FieldModel& model_;
  const LevelView& level_;
  std::uint32_t coefficient_;
  std::uint32_t end_;
};

// the sums of four coefficients of a tile, as one vector each
void add_four(const TileSums& tile, std::size_t half, Float4* sums) {
  const Float4 x = tile.of[0][half];
  const Float4 y = tile.of[1][half];
  const Float4 z = tile.of[2][half];
  const Float4 xy_low = __builtin_shufflevector(x, y, 0, 4, 1, 5);
  const Float4 xy_high = __builtin_shufflevector(x, y, 2, 6, 3, 7);
  const Float4 z_low = __builtin_shufflevector(z, Float4{}, 0, 4, 1, 5);
  const Float4 z_high = __builtin_shufflevector(z, Float4{}, 2, 6, 3, 7);
  sums[0] += __builtin_shufflevector(xy_low, z_low, 0, 1, 4, 5);
  sums[1] += __builtin_shufflevector(xy_low, z_low, 2, 3, 6, 7);
  sums[2] += __builtin_shufflevector(xy_high, z_high, 0, 1, 4, 5);
  sums[3] += __builtin_shufflevector(xy_high, z_high, 2, 3, 6, 7);
}

// moves the sums of tiles to those of blocks
void add_tile_sums(std::uint32_t end, const CoefficientSums& sums) {
  for (std::uint32_t t = 0; t < tiles_of(end); ++t) {
    Float4* const of_blocks = sums.of_blocks + std::size_t{BaseColumns::width} * t;
    add_four(sums.of_tiles[t], 0, of_blocks);
    add_four(sums.of_tiles[t], 1, of_blocks + 4);
    sums.of_tiles[t] = {};
  }
  for (std::uint32_t i = end; i < BaseColumns::width * tiles_of(end); ++i) {
    sums.of_blocks[i] = Float4{};  // of a tile that a field is cut in
  }
}

}  // namespace

void count_field_blocks(const ModelView& view, const MirroredCouplings& mirrored, const BaseColumns& base,
                        std::uint32_t* up_to) noexcept {
  for (std::uint32_t own = 0; own < view.levels; ++own) {
    const LevelView& level = view.level[own];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (std::uint32_t q = 0; q < view.levels; ++q, ++up_to) {
        const std::uint32_t end = domain_up_to(view, q);
        *up_to = level.domain_begin + i < end ? 1 : 0;
        *up_to += level.domain_begin + i < base.columns ? FieldBlocks::of_tile * tiles_of(end) : 0;
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

void scale_sums(const ModelView& view, std::uint32_t end, const CoefficientSums& sums) noexcept {
  if (sums.of_tiles != nullptr) {
    add_tile_sums(end, sums);
  }
  for (std::uint32_t q = 0; q < view.levels && view.level[q].domain_begin < end; ++q) {
    const LevelView& level = view.level[q];
    Float4* const sum = sums.of_blocks + level.domain_begin;
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      sum[i] = symmetric_product(level.scales_of<3>()[i].root, sum[i]);
    }
  }
}

void sum_couplings(const FieldModel& model, const Touched& touched, std::uint32_t end, Float4* force,
                   const CoefficientSums& sums) noexcept {
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t coefficient = touched.list[q][k];
      CoefficientColumn(model, coefficient, end).add(force[coefficient], sums);
      force[coefficient] = Float4{};
    }
  }
}

void compute_field(const FieldModel& model, const ColumnForces& forces, const Touched& touched,
                   const FieldLevels& levels, const FieldScratch& scratch, Float4* x) noexcept {
  const ModelView& view = *model.refinement.view;
  transform_forces(model.refinement, forces, touched, scratch.force);
  sum_couplings(model, touched, domain_up_to(view, levels.details), scratch.force, scratch.sums);
  scale_sums(view, domain_up_to(view, levels.details), scratch.sums);
  inverse_transform(view, model.offsets, levels, scratch.sums.of_blocks, x);
}

}  // namespace greenloop
