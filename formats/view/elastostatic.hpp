#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/layout/elastostatic.hpp"

namespace greenloop {

/// Couplings(q, layer) in place: see layout::CouplingsHeader.
struct CouplingsView {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::uint32_t index_bytes = 0;
  const std::uint32_t* begin = nullptr;  ///< [columns + 1]
  const void* index = nullptr;           ///< u16 or u32 by index_bytes
  const std::byte* value = nullptr;      ///< by the layer's value_bits
};

/// Predictions(q) in place: see layout::PredictionsHeader.
struct PredictionsView {
  std::uint32_t terms = 0;
  std::uint32_t index_bytes = 0;
  const void* index = nullptr;        ///< u16 or u32 by index_bytes; [domain nodes * terms]
  const std::byte* weight = nullptr;  ///< i16 [N N] a term; null without Equilibrated wavelets
};

/// One level of the mesh, in place.
struct LevelView {
  const layout::Level* counts = nullptr;
  std::uint32_t node_begin = 0;    ///< file index of its first node, where its domain begins too
  std::uint32_t domain_begin = 0;  ///< domain nodes of all coarser levels
  const layout::NodeRecord* nodes = nullptr;
  const layout::RefinementRecord* refinement = nullptr;  ///< null on level 0
  const layout::StencilRecord* stencils = nullptr;       ///< [domain nodes]; null without Butterfly wavelets
  PredictionsView predictions;
  const void* scales = nullptr;  ///< layout::Scale<components> [domain nodes]
  CouplingsView couplings[layout::layers];
  std::span<const layout::PatternRecord> patterns;  ///< empty: not measured, or no constraint level
  const float* load_columns = nullptr;              ///< m a unit, [loads][domain nodes][3]; null: the model has none

  /// The coefficients of the level's domain nodes under one unit of a load: [domain nodes][3], m.
  [[nodiscard]] const float* load_column(std::uint32_t load) const noexcept {
    return load_columns + std::size_t{3} * counts->domain_count * load;
  }
  /// N: the model's components.
  template <unsigned N>
  [[nodiscard]] const layout::Scale<N>* scales_of() const noexcept {
    return static_cast<const layout::Scale<N>*>(scales);
  }
};

/// The couplings of the coefficients of level 0 with those after them, where nearly all exist, of bodies of 512
/// coefficients and more: whole columns without indices, eight coefficients side by side, so that a field sums them
/// without gathering. They hold the layers of 8 and 4 bits, as far as these have one quantum; what needs 16 bits stays
/// among the mirrored couplings.
struct BaseColumns {
  static constexpr std::uint32_t quantum_layer = 2;           ///< whose quantum they have: that of 8 bits
  static constexpr std::uint32_t width = layout::tile_width;  ///< coefficients of a tile, of consecutive places

  /// Of a tile of N x N blocks, whose elements k are the 8 bytes from 8 k on.
  template <unsigned N>
  static constexpr std::size_t tile_bytes = std::size_t{N} * N* width;

  std::uint32_t columns = 0;         ///< level 0's, or none
  std::uint32_t tiles = 0;           ///< of a column
  bool holds[layout::layers] = {};   ///< its layers
  const std::byte* value = nullptr;  ///< [columns * tiles * tile_bytes<N>]

  template <unsigned N>
  [[nodiscard]] const std::byte* column(std::uint32_t c) const {
    return value + tile_bytes<N> * tiles * c;
  }
};

/// The half of the couplings that Couplings sections leave out, but for what BaseColumns hold. They store the blocks of
/// a coefficient with those before it; these are the blocks with those after it, transposed, in the same layers and the
/// same stored values: `layer[...]` has a column for every domain node, whose rows are coefficients of larger places,
/// increasing.
struct MirroredCouplings {
  CouplingsView layer[layout::layers];
};

/// What follows from the sections of the levels and stands in a file that is ready, so that a start need not make it.
struct ReadyTables {
  const std::uint8_t* read = nullptr;  ///< [domain] 1: blocks that move the coefficient are mirrored; null: not ready
  BaseColumns base;
  MirroredCouplings mirrored;
};

/// An elastostatic or scalar model, in place.
struct ElastostaticView {
  const layout::Info* info = nullptr;
  std::uint32_t levels = 0;        ///< levels present
  std::uint32_t node_count = 0;    ///< over all levels present
  std::uint32_t domain_count = 0;  ///< over all levels present
  const std::uint32_t* base_triangles = nullptr;
  LevelView level[layout::max_levels];
  /// [constraint level][mesh level]
  const std::uint32_t* representatives[layout::max_levels][layout::max_levels] = {};
  std::span<const layout::VertexRecord> vertices;  ///< of the author's surface, in its order; empty: not kept
  std::span<const layout::LoadRecord> loads;       ///< accelerations along x, y and z or none of them, then pressures
  ReadyTables ready;

  /// Whether the first three loads are the accelerations.
  [[nodiscard]] bool has_gravity() const noexcept {
    return !loads.empty() && loads[0].kind == static_cast<std::uint32_t>(layout::LoadKind::acceleration_x);
  }
};

}  // namespace greenloop
