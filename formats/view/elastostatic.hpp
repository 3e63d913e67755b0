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

  /// N: the model's components.
  template <unsigned N>
  [[nodiscard]] const layout::Scale<N>* scales_of() const noexcept {
    return static_cast<const layout::Scale<N>*>(scales);
  }
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
};

}  // namespace greenloop
