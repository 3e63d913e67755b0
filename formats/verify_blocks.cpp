#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/verify_sections.hpp"

namespace greenloop {
namespace {

using layout::BlocksHeader;

constexpr std::uint64_t values_per_block = 9;
constexpr std::uint64_t tail_bytes = 16;  // a wide load of the last block stays inside the section

constexpr std::uint64_t align(std::uint64_t offset) {
  return (offset + layout::alignment - 1) / layout::alignment * layout::alignment;
}

// Where the arrays of a Blocks section must stand. No overflow: block_count < 2^32, the other factors are smaller.
struct BlocksExtent {
  std::uint64_t begin_end, scale, scale_end, index, index_end, value, value_end;

  explicit BlocksExtent(const BlocksHeader& header)
      : begin_end(sizeof(BlocksHeader) + (std::uint64_t{header.columns} + 1) * sizeof(std::uint32_t)),
        scale(align(begin_end)),
        scale_end(scale + std::uint64_t{header.columns} * sizeof(float)),
        index(header.index_bytes == 0 ? 0 : align(scale_end)),
        index_end(header.index_bytes == 0 ? scale_end : index + header.block_count * header.index_bytes),
        value(align(index_end)),
        value_end(value + values_per_block * header.block_count * header.value_bytes) {}
};

bool verify_blocks_header(SectionCheck& check, const BlocksHeader& header, std::uint32_t columns, std::uint32_t rows) {
  const std::uint64_t most = std::min(std::uint64_t{columns} * rows, std::uint64_t{layout::none});
  const auto blocks = static_cast<double>(header.block_count);
  return check.require(header.columns == columns, VerifyRule::inconsistent, "columns", 0, header.columns, columns) &&
         check.require(header.rows == rows, VerifyRule::inconsistent, "rows", 0, header.rows, rows) &&
         check.require(header.value_bytes == 1 || header.value_bytes == 2, VerifyRule::bad_enum, "value_bytes", 0,
                       header.value_bytes, 2) &&
         check.require(header.index_bytes == 0 || header.index_bytes == 2 || header.index_bytes == 4,
                       VerifyRule::bad_enum, "index_bytes", 0, header.index_bytes, 4) &&
         check.require(header.index_bytes != 2 || rows <= 65536, VerifyRule::inconsistent, "index_bytes", 0, 2, 4) &&
         check.require(header.block_count <= most, VerifyRule::out_of_range, "block_count", 0, blocks,
                       static_cast<double>(most)) &&
         check.require(header.index_bytes != 0 || header.block_count == std::uint64_t{columns} * rows,
                       VerifyRule::inconsistent, "block_count", 0, blocks,
                       static_cast<double>(std::uint64_t{columns} * rows));
}

bool verify_extent(SectionCheck& check, const Section& section, const BlocksHeader& header,
                   const BlocksExtent& extent) {
  const auto at = [&](const char* field, std::uint64_t offset, std::uint64_t expected) {
    return check.require(offset == expected, VerifyRule::inconsistent, field, 0, static_cast<double>(offset),
                         static_cast<double>(expected));
  };
  return at("begin_offset", header.begin_offset, sizeof(BlocksHeader)) &&
         at("scale_offset", header.scale_offset, extent.scale) &&
         at("index_offset", header.index_offset, extent.index) &&
         at("value_offset", header.value_offset, extent.value) &&
         check.require(section.bytes >= extent.value_end + tail_bytes, VerifyRule::section_size, "bytes", 0,
                       static_cast<double>(section.bytes), static_cast<double>(extent.value_end + tail_bytes));
}

bool verify_gaps(SectionCheck& check, const Section& section, const BlocksExtent& extent) {
  const auto zero = [&](std::uint64_t begin, std::uint64_t end) {
    const std::span gap(section.data + begin, static_cast<std::size_t>(end - begin));
    return check.require(all_zero(gap), VerifyRule::padding_not_zero, "padding", begin, 1, 0);
  };
  return zero(extent.begin_end, extent.scale) && (extent.index == 0 || zero(extent.scale_end, extent.index)) &&
         zero(extent.index_end, extent.value) && zero(extent.value_end, section.bytes);
}

bool verify_begin(SectionCheck& check, const BlocksHeader& header, const std::uint32_t* begin) {
  if (!check.require(begin[0] == 0, VerifyRule::inconsistent, "begin", 0, begin[0], 0)) return false;
  for (std::uint32_t j = 0; j < header.columns; ++j) {
    if (!check.require(begin[j + 1] >= begin[j], VerifyRule::not_increasing, "begin", j + 1u, begin[j + 1], begin[j])) {
      return false;
    }
    const std::uint64_t kept = begin[j + 1] - begin[j];
    const bool right = header.index_bytes == 0 ? kept == header.rows : kept <= header.rows;
    if (!check.require(right, VerifyRule::inconsistent, "begin", j + 1u, begin[j + 1],
                       static_cast<double>(std::uint64_t{begin[j]} + header.rows))) {
      return false;
    }
  }
  const auto blocks = static_cast<double>(header.block_count);
  return check.require(begin[header.columns] == header.block_count, VerifyRule::inconsistent, "begin", header.columns,
                       begin[header.columns], blocks);
}

bool verify_scale(SectionCheck& check, const BlocksHeader& header, const float* scale) {
  for (std::uint32_t j = 0; j < header.columns; ++j) {
    if (!check.require(std::isfinite(scale[j]), VerifyRule::not_finite, "scale", j, scale[j], 0) ||
        !check.require(scale[j] >= 0, VerifyRule::out_of_range, "scale", j, scale[j], 0)) {
      return false;
    }
  }
  return true;
}

template <class Index>
bool verify_index(SectionCheck& check, const BlocksHeader& header, const std::uint32_t* begin, const Index* index) {
  for (std::uint32_t j = 0; j < header.columns; ++j) {
    for (std::uint32_t b = begin[j]; b < begin[j + 1]; ++b) {
      if (!check.require(index[b] < header.rows, VerifyRule::out_of_range, "index", b, index[b], header.rows - 1.0) ||
          !check.require(b == begin[j] || index[b] > index[b - 1], VerifyRule::not_increasing, "index", b, index[b],
                         b == begin[j] ? 0 : index[b - 1])) {
        return false;
      }
    }
  }
  return true;
}

// the most negative value has no counterpart, so that negation never overflows
template <class Value>
bool verify_values(SectionCheck& check, const BlocksHeader& header, const Value* value) {
  const std::uint64_t count = values_per_block * header.block_count;
  constexpr Value forbidden = std::numeric_limits<Value>::min();
  const Value* found = std::find(value, value + count, forbidden);
  return check.require(found == value + count, VerifyRule::out_of_range, "value",
                       static_cast<std::uint64_t>(found - value), forbidden, forbidden + 1);
}

}  // namespace

bool verify_blocks(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require(section.bytes >= sizeof(BlocksHeader), VerifyRule::section_size, "bytes", 0,
                     static_cast<double>(section.bytes), sizeof(BlocksHeader))) {
    return false;
  }
  const auto& header = *section.as<BlocksHeader>();
  const std::uint32_t columns = context.view.level[section.a].counts->column_count;
  const std::uint32_t rows = context.view.level[section.b].counts->domain_count;
  if (!verify_blocks_header(check, header, columns, rows) ||
      !check.require(!context.reserved_is_zero || header.reserved == 0, VerifyRule::reserved_not_zero, "reserved", 0,
                     static_cast<double>(header.reserved), 0)) {
    return false;
  }
  const BlocksExtent extent(header);
  if (!verify_extent(check, section, header, extent) || !verify_gaps(check, section, extent)) return false;

  const auto* begin = reinterpret_cast<const std::uint32_t*>(section.data + header.begin_offset);
  const auto* scale = reinterpret_cast<const float*>(section.data + header.scale_offset);
  const std::byte* index = header.index_bytes == 0 ? nullptr : section.data + header.index_offset;
  const std::byte* value = section.data + header.value_offset;
  if (!verify_begin(check, header, begin) || !verify_scale(check, header, scale)) return false;
  const bool indices_right =
      header.index_bytes == 0 ||
      (header.index_bytes == 2 ? verify_index(check, header, begin, reinterpret_cast<const std::uint16_t*>(index))
                               : verify_index(check, header, begin, reinterpret_cast<const std::uint32_t*>(index)));
  const bool right =
      indices_right &&
      (header.value_bytes == 1 ? verify_values(check, header, reinterpret_cast<const std::int8_t*>(value))
                               : verify_values(check, header, reinterpret_cast<const std::int16_t*>(value)));
  if (!right) return false;

  context.present_blocks[section.a] += header.block_count;
  context.view.blocks[section.a][section.b] = {columns, rows, header.value_bytes, header.index_bytes, begin, scale,
                                               index,   value};
  return true;
}

}  // namespace greenloop
