#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/compliance/base_columns.hpp"
#include "runtime/compliance/capacitance.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/compliance/mirrored_couplings.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/glide.hpp"
#include "runtime/elastostatic/mixture.hpp"
#include "runtime/elastostatic/requirement.hpp"
#include "runtime/elastostatic/step_work.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/factor/factor_update.hpp"
#include "runtime/factor/pending_factor.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/sparse_forces.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

/// Everything that a body keeps in its arena.
struct Body {
  const ModelView* view = nullptr;
  ModelCounts counts;
  std::uint64_t least_work = 0;
  float force_limit = 0;  ///< N: forces whose magnitudes sum to no more cannot overflow the field
  Lifting lifting;
  Refinement refinement;
  MirroredCouplings mirrored;
  BlockSums block_sums = portable_block_sums();
  FieldBlocks field_blocks;
  BaseColumns base;
  AddTiles add_tiles = greenloop::add_tiles;
  CoefficientSums field_sums{};     ///< zero between steps
  PredictionOffsets offsets;        ///< empty without fields
  std::uint32_t* stored = nullptr;  ///< [domain] blocks of all layers in a coefficient's column
  ColumnCosts cost;
  NodeFacts* facts = nullptr;  ///< [node_count]
  ContactSet set;
  Touched touched;  ///< by the set
  CapacitanceScratch capacitance;
  FactorChanges changes;  ///< what tells the nearest cached factor from the planned set
  FactorUpdateScratch update;
  Float4* column_force = nullptr;  ///< displacements, then forces of the set's columns
  Float4* solution = nullptr;      ///< the same in the order of a factor
  Float4* force = nullptr;         ///< [domain], zero between steps
  FactorCache cache;
  PendingFactor pending;
  Glide glide;
  Mixture mixture;
  const std::byte* last_red_zone = nullptr;

  [[nodiscard]] FieldModel field_model() const { return {refinement, mirrored, base, offsets, block_sums, add_tiles}; }
  [[nodiscard]] FieldScratch field_scratch() const { return {force, field_sums}; }
};

/// Carves a body's arrays and fills in what follows from the model. Null while `arena` only counts. `view` must outlive
/// the body. Start-up; linear in the model's nodes and, for every level, its blocks.
Body* place_body(Arena& arena, const ModelView& view, const BodySizes& sizes) noexcept;

}  // namespace greenloop
