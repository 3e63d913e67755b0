#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/compliance/capacitance.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/factor/factor_job.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

/// For TEST_CASE_TEMPLATE: numbers of components of a model.
using One = std::integral_constant<unsigned, 1>;
using Three = std::integral_constant<unsigned, 3>;

/// What the rooms wavelet, compliance and factor keep of a model of N components, in memory of its own, for sets of so
/// many columns. The view must outlive it.
template <unsigned N>
class Rooms {
 public:
  explicit Rooms(const ModelView& of_model, std::uint32_t set_columns = 1, bool keeps_capacitance = false);
  Rooms(const Rooms&) = delete;  // it refers to itself
  Rooms& operator=(const Rooms&) = delete;

  [[nodiscard]] FieldModel<N> field_model() const {
    return {refinement, mirrored, base, offsets, block_sums, fastest_add_tiles<N>()};
  }
  [[nodiscard]] FieldScratch<N> field_scratch() const { return {force, field_sums}; }
  [[nodiscard]] FactorTools<N> factor_tools() {
    return {counts, refinement, cost, stored.data(), cache, capacitance, factoring, force, index_of_place.data()};
  }

  /// Touches what a set reaches, instead of what was touched before, and counts what its factor takes.
  SetCounts touch_set(ColumnSet set);

  const ModelView& view;
  FactorCounts counts;
  Lifting lifting;
  Refinement refinement;
  PredictionOffsets<N> offsets;
  BaseColumns base;
  MirroredCouplings mirrored;
  BlockSums<N> block_sums = fastest_block_sums<N>();
  FieldBlocks field_blocks;
  CoefficientSums<N> field_sums{};
  Vector<N>* force = nullptr;  ///< [domain]
  Touched touched;
  ColumnCosts cost;
  std::vector<std::uint32_t> stored;  ///< [domain] blocks of all layers in a coefficient's column
  CapacitanceScratch<N> capacitance;
  FactorCache cache;
  FactorScratch factoring;
  FactorJob job;
  std::vector<std::uint32_t> index_of_place;  ///< [domain]

 private:
  void carve(Arena& arena, std::uint32_t set_columns);
  void list_costs();
  void prepare_fields();

  RefinementTables tables_;
  BaseColumnsMaker<N> base_maker_;
  MirroredCouplingsMaker<N> mirrored_maker_;
  std::vector<ColumnCost> costs_[layout::max_levels];
  std::vector<std::uint32_t> column_blocks_[layout::max_levels];
  std::vector<std::uint32_t> up_to_;
  AlignedBytes memory_;
};

/// Whether a fourth lane, if there is one, is 0.
inline bool is_padded(Float4 x) { return x[3] == 0; }
inline bool is_padded(float) { return true; }

/// Whether all lanes are 0.
template <unsigned N>
bool is_zero(Vector<N> x) {
  bool zero = is_padded(x);
  for (std::size_t r = 0; r < N; ++r) zero = zero && component(x, r) == 0;
  return zero;
}

/// Columns of level c at some places, increasing.
[[nodiscard]] std::vector<std::uint32_t> columns_at(std::uint32_t c, std::vector<std::uint32_t> places);

}  // namespace greenloop
