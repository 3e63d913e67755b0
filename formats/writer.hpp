#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "formats/layout.hpp"

namespace greenloop {

/// Blocks(c, r) before encoding; see layout::BlocksHeader.
struct BlocksData {
  std::uint32_t value_bytes = 1;     ///< 1: values in -127..127, 2: -32767..32767
  bool dense = false;                ///< every column keeps every row; `index` stays empty
  std::vector<std::uint32_t> begin;  ///< columns + 1
  std::vector<float> scale;          ///< columns
  std::vector<std::uint32_t> index;  ///< rows within the level's domain; stored in 2 bytes where they fit
  std::vector<std::int16_t> value;   ///< 9 per block, by columns
};

/// One level of a model before encoding.
struct LevelData {
  layout::Level counts{};
  std::vector<layout::NodeRecord> nodes;
  std::vector<layout::RefinementRecord> refinement;  ///< empty on level 0
  std::vector<layout::ColumnRecord> columns;         ///< GFs of this constraint level; may be empty
  std::vector<std::vector<std::uint32_t>>
      representatives;             ///< [mesh level][node in that level], every mesh level; empty without columns
  std::vector<BlocksData> blocks;  ///< [row level], every mesh level; empty without columns
};

/// A whole model before encoding. Offline only.
struct ModelData {
  layout::Info info{};
  std::string provenance;
  std::vector<std::uint32_t> base_triangles;
  std::vector<LevelData> levels;
};

/// The bytes of a model file: deterministic, complete, checksummed. Throws std::invalid_argument naming the field that
/// does not fit. Filled in from the vectors, whatever stands there: Info::levels, finest_constraint_level and the box;
/// Level's node, domain, column, triangle, kept and dense counts. The result has passed verify.
[[nodiscard]] std::vector<std::byte> encode(const ModelData& model);

/// The same model cut off after level q: a prefix with its header rewritten. Throws std::invalid_argument if q is not
/// a level of the file or no constraint level at or below q has columns.
[[nodiscard]] std::vector<std::byte> truncate_to_level(std::vector<std::byte> model, std::uint32_t q);

/// Writes through a temporary file beside `path` and a rename, so that `path` is never half written.
/// Throws std::runtime_error naming the file and the reason.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace greenloop
