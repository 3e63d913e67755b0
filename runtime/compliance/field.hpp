#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/compliance/base_columns.hpp"
#include "runtime/compliance/column_blocks.hpp"
#include "runtime/compliance/mirrored_couplings.hpp"
#include "runtime/compliance/model_loads.hpp"
#include "runtime/wavelet/force_transform.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

/// What compute_field reads.
template <unsigned N>
struct FieldModel {
  const Refinement& refinement;
  const MirroredCouplings& mirrored;
  const BaseColumns& base;
  const PredictionOffsets<N>& offsets;
  const BlockSums<N>& sums;  ///< what blocks are summed with
  AddTiles<N> add_tiles;     ///< and tiles
};

/// What is summed, in units of the coefficients' scales: the sums of both, zero between uses.
template <unsigned N>
struct CoefficientSums {
  Vector<N>* of_blocks;   ///< [domain, up to a whole tile]
  TileSums<N>* of_tiles;  ///< [tiles_of(domain)]; null without BaseColumns
};

/// Arrays of compute_field: zero before and after.
template <unsigned N>
struct FieldScratch {
  Vector<N>* force;  ///< [domain]
  CoefficientSums<N> sums;
};

/// How many blocks a force on a coefficient is summed with, by the levels that it moves: every one that the file has of
/// it. Coefficients that forces reach are summed once, however many contacts share them.
struct FieldBlocks {
  /// A tile of BaseColumns counts as so many blocks of N x N.
  template <unsigned N>
  static constexpr auto of_tile = static_cast<std::uint32_t>((tile_work<N> + block_work<N> - 1) / block_work<N>);

  std::uint32_t levels = 0;
  const std::uint32_t* up_to = nullptr;  ///< [domain * levels] blocks that move levels 0..q

  [[nodiscard]] std::uint32_t count(std::uint32_t coefficient, std::uint32_t field_level) const noexcept {
    return up_to[std::size_t{coefficient} * levels + field_level];
  }
};

/// Fills up_to: [domain * levels]. Start-up; linear in the blocks.
template <unsigned N>
void count_field_blocks(const ModelView& view, const MirroredCouplings& mirrored, const BaseColumns& base,
                        std::uint32_t* up_to) noexcept;

/// sums += W U W^T times force coefficients, in units of the scales of the coefficients before `end`, which are moved.
/// force: [domain] of touched coefficients; zero afterwards. For the loop; work: Prices::summed_block per block of
/// FieldBlocks and coefficient per coefficient.
template <unsigned N>
void sum_couplings(const FieldModel<N>& model, const Touched& touched, std::uint32_t end, Vector<N>* force,
                   const CoefficientSums<N>& sums) noexcept;

/// Adds the sums of tiles to those of blocks and scales these, for the coefficients before `end`; those of tiles are
/// zero afterwards. For the loop; work: Prices::scaled_sum per coefficient.
template <unsigned N>
void scale_sums(const ModelView& view, std::uint32_t end, const CoefficientSums<N>& sums) noexcept;

/// What forces on columns add to the sums of the coefficients before `end`. touched: by the same columns. For the loop;
/// work: that of transform_forces and sum_couplings.
template <unsigned N>
void sum_forces(const FieldModel<N>& model, const ColumnForces& forces, const Touched& touched, std::uint32_t end,
                const FieldScratch<N>& scratch) noexcept;

/// Fast summation in two-sided form (James & Pai 2003, section 5.4; docs/theory.md): x = W^-1 (W U W^T) T^-T f, the
/// displacement of the nodes of K(levels.nodes) by some forces, with details up to levels.details, interpolated beyond.
/// It is that of the very compliance whose forces hold the contacts: all couplings, none left out. touched: by the same
/// columns; x: [nodes of K(levels.nodes)], all of which are written. What is in the sums already, and of three
/// components what loads of the model displace, is added to it. For the loop; work: field_work, and that of add_loads.
template <unsigned N>
void compute_field(const FieldModel<N>& model, const ColumnForces& forces, const Touched& touched,
                   const FieldLevels& levels, const FieldScratch<N>& scratch, Vector<N>* x,
                   const ActingLoads& loads = {}) noexcept;

}  // namespace greenloop
