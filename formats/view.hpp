#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/layout.hpp"

namespace greenloop {

/// Blocks(c, r) in place: columns of constraint level c, wavelet rows of mesh level r. See layout::BlocksHeader.
struct BlocksView {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::uint32_t value_bytes = 0;
  std::uint32_t index_bytes = 0;
  const std::uint32_t* begin = nullptr;  ///< [columns + 1]
  const float* scale = nullptr;          ///< [columns], m/N per quantum
  const void* index = nullptr;           ///< u16 or u32 by index_bytes; null if dense
  const void* value = nullptr;           ///< i8 or i16 by value_bytes
};

/// One level of the mesh, in place.
struct LevelView {
  const layout::Level* counts = nullptr;
  std::uint32_t node_begin =
      0;  ///< file index of its first node; its domain is [node_begin, node_begin + domain_count)
  const layout::NodeRecord* nodes = nullptr;
  const layout::RefinementRecord* refinement = nullptr;  ///< null on level 0
  const layout::ColumnRecord* columns = nullptr;         ///< GFs of the constraint level of the same number
};

/// A verified model file, in place: pointers into the caller's bytes, which must outlive it and stay unchanged.
/// Trivially copyable; no heap. Made by greenloop::verify only.
struct ModelView {
  const layout::Header* header = nullptr;
  const layout::Info* info = nullptr;
  std::span<const char> provenance;
  std::uint32_t levels = 0;        ///< levels present
  std::uint32_t node_count = 0;    ///< over all levels present
  std::uint32_t domain_count = 0;  ///< over all levels present
  const std::uint32_t* base_triangles = nullptr;
  LevelView level[layout::max_levels];
  BlocksView blocks[layout::max_levels][layout::max_levels];                     ///< [constraint level][row level]
  const std::uint32_t* representatives[layout::max_levels][layout::max_levels];  ///< [constraint level][mesh level]
};

}  // namespace greenloop
