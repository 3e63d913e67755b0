#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/verify_sections.hpp"

namespace greenloop {
namespace {

using layout::CouplingsHeader;
using layout::Partner;

constexpr std::uint64_t values_per_block = 9;
constexpr std::uint64_t tail_bytes = 16;  // a wide load of the last block stays inside the section

constexpr std::uint64_t align(std::uint64_t offset) {
  return (offset + layout::alignment - 1) / layout::alignment * layout::alignment;
}

constexpr std::uint64_t bytes_per_block(std::uint32_t value_bits) {
  return value_bits == 4 ? 5 : values_per_block * value_bits / 8;
}

// Where the arrays must stand. No overflow: columns and block_count are below 2^32, the other factors at most 18.
struct Extent {
  std::uint64_t begin_end, index, index_end, value, value_end;

  explicit Extent(const CouplingsHeader& header)
      : begin_end(sizeof(CouplingsHeader) + (std::uint64_t{header.columns} + 1) * sizeof(std::uint32_t)),
        index(header.index_bytes == 0 ? 0 : align(begin_end)),
        index_end(header.index_bytes == 0 ? begin_end : index + header.block_count * header.index_bytes),
        value(align(index_end)),
        value_end(value + header.block_count * bytes_per_block(header.value_bits)) {}
};

// What the place of a section says about it.
struct Expected {
  std::uint32_t columns, rows;
  bool triangular;  // rows lie before their column
  bool base;        // level 0: every block, 16 bits, no index

  Expected(const Section& section, const ModelView& view) {
    const std::uint32_t q = section.a;
    const auto partner = static_cast<Partner>(section.b / layout::strengths);
    columns = view.level[q].counts->domain_count;
    rows = partner == Partner::same      ? columns
           : partner == Partner::parents ? view.level[q - 1].counts->domain_count
                                         : domain_of_mesh(view, q < 2 ? 0 : q - 2);
    triangular = partner == Partner::same;
    base = q == 0;
  }

  // the blocks there can be
  [[nodiscard]] std::uint64_t all_blocks() const {
    if (!triangular) return std::uint64_t{columns} * rows;
    return columns == 0 ? 0 : std::uint64_t{columns} * (columns - 1) / 2;
  }
  [[nodiscard]] std::uint32_t rows_of(std::uint32_t column) const { return triangular ? column : rows; }
};

bool verify_form(SectionCheck& check, const CouplingsHeader& header, const Expected& expected) {
  const auto is = [&](const char* field, std::uint32_t value, std::uint32_t right) {
    return check.require(value == right, VerifyRule::inconsistent, field, 0, value, right);
  };
  const auto one_of = [&](const char* field, std::uint32_t value, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return check.require(value == a || value == b || value == c, VerifyRule::bad_enum, field, 0, value, c);
  };
  return is("columns", header.columns, expected.columns) && is("rows", header.rows, expected.rows) &&
         one_of("value_bits", header.value_bits, 4, 8, 16) && one_of("index_bytes", header.index_bytes, 0, 2, 4) &&
         (!expected.base || is("value_bits", header.value_bits, 16)) &&
         check.require((header.index_bytes == 0) == expected.base, VerifyRule::inconsistent, "index_bytes", 0,
                       header.index_bytes, expected.base ? 0 : 4) &&
         check.require(header.index_bytes != 2 || header.rows <= 65536, VerifyRule::inconsistent, "index_bytes", 0, 2,
                       4);
}

bool verify_header(SectionCheck& check, const CouplingsHeader& header, const Expected& expected) {
  const std::uint64_t most = std::min(expected.all_blocks(), std::uint64_t{layout::none});
  const auto blocks = static_cast<double>(header.block_count);
  return verify_form(check, header, expected) &&
         check.require(header.block_count <= most, VerifyRule::out_of_range, "block_count", 0, blocks,
                       static_cast<double>(most)) &&
         check.require(!expected.base || header.block_count == expected.all_blocks(), VerifyRule::inconsistent,
                       "block_count", 0, blocks, static_cast<double>(expected.all_blocks())) &&
         check.require(std::isfinite(header.quantum), VerifyRule::not_finite, "quantum", 0, header.quantum, 1) &&
         check.require(header.quantum >= 0 && header.quantum <= 1, VerifyRule::out_of_range, "quantum", 0,
                       header.quantum, header.quantum < 0 ? 0 : 1);
}

bool verify_extent(SectionCheck& check, const Section& section, const CouplingsHeader& header, const Extent& extent) {
  const auto at = [&](const char* field, std::uint64_t offset, std::uint64_t expected) {
    return check.require(offset == expected, VerifyRule::inconsistent, field, 0, static_cast<double>(offset),
                         static_cast<double>(expected));
  };
  return at("begin_offset", header.begin_offset, sizeof(CouplingsHeader)) &&
         at("index_offset", header.index_offset, extent.index) &&
         at("value_offset", header.value_offset, extent.value) &&
         check.require(section.bytes >= extent.value_end + tail_bytes, VerifyRule::section_size, "bytes", 0,
                       static_cast<double>(section.bytes), static_cast<double>(extent.value_end + tail_bytes));
}

bool verify_gaps(SectionCheck& check, const Section& section, const Extent& extent) {
  const auto zero = [&](std::uint64_t begin, std::uint64_t end) {
    const std::span gap(section.data + begin, static_cast<std::size_t>(end - begin));
    return check.require(all_zero(gap), VerifyRule::padding_not_zero, "padding", begin, 1, 0);
  };
  return (extent.index == 0 || zero(extent.begin_end, extent.index)) && zero(extent.index_end, extent.value) &&
         zero(extent.value_end, section.bytes);
}

bool verify_begin(SectionCheck& check, const CouplingsHeader& header, const Expected& expected,
                  const std::uint32_t* begin) {
  if (!check.require(begin[0] == 0, VerifyRule::inconsistent, "begin", 0, begin[0], 0)) return false;
  for (std::uint32_t j = 0; j < header.columns; ++j) {
    if (!check.require(begin[j + 1] >= begin[j], VerifyRule::not_increasing, "begin", j + 1u, begin[j + 1], begin[j])) {
      return false;
    }
    const std::uint32_t kept = begin[j + 1] - begin[j], most = expected.rows_of(j);
    if (!check.require(expected.base ? kept == most : kept <= most, VerifyRule::inconsistent, "begin", j + 1u,
                       begin[j + 1], static_cast<double>(std::uint64_t{begin[j]} + most))) {
      return false;
    }
  }
  return check.require(begin[header.columns] == header.block_count, VerifyRule::inconsistent, "begin", header.columns,
                       begin[header.columns], static_cast<double>(header.block_count));
}

template <class Index>
bool verify_index(SectionCheck& check, const CouplingsHeader& header, const Expected& expected,
                  const std::uint32_t* begin, const Index* index) {
  for (std::uint32_t j = 0; j < header.columns; ++j) {
    for (std::uint32_t b = begin[j]; b < begin[j + 1]; ++b) {
      if (!check.require(index[b] < expected.rows_of(j), VerifyRule::out_of_range, "index", b, index[b],
                         expected.rows_of(j) - 1.0) ||
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
bool verify_values(SectionCheck& check, const CouplingsHeader& header, const Value* value) {
  const std::uint64_t count = values_per_block * header.block_count;
  constexpr Value forbidden = std::numeric_limits<Value>::min();
  const Value* found = std::find(value, value + count, forbidden);
  return check.require(found == value + count, VerifyRule::out_of_range, "value",
                       static_cast<std::uint64_t>(found - value), forbidden, forbidden + 1);
}

bool verify_nibbles(SectionCheck& check, const CouplingsHeader& header, const std::byte* value) {
  for (std::uint64_t b = 0; b < header.block_count; ++b, value += bytes_per_block(4)) {
    for (std::uint64_t k = 0; k < values_per_block; ++k) {
      const auto nibble = std::to_integer<std::uint32_t>(value[k / 2]) >> (4 * (k % 2)) & 15U;
      if (!check.require(nibble != 8, VerifyRule::out_of_range, "value", values_per_block * b + k, -8, -7))
        return false;
    }
    const auto tenth = std::to_integer<std::uint32_t>(value[4]) >> 4U;
    if (!check.require(tenth == 0, VerifyRule::padding_not_zero, "value", values_per_block * (b + 1) - 1, tenth, 0)) {
      return false;
    }
  }
  return true;
}

bool verify_blocks(SectionCheck& check, const CouplingsView& view, const CouplingsHeader& header,
                   const Expected& expected) {
  if (!verify_begin(check, header, expected, view.begin)) return false;
  if (view.index_bytes == 2 &&
      !verify_index(check, header, expected, view.begin, static_cast<const std::uint16_t*>(view.index))) {
    return false;
  }
  if (view.index_bytes == 4 &&
      !verify_index(check, header, expected, view.begin, static_cast<const std::uint32_t*>(view.index))) {
    return false;
  }
  switch (view.value_bits) {
    case 4:
      return verify_nibbles(check, header, view.value);
    case 8:
      return verify_values(check, header, reinterpret_cast<const std::int8_t*>(view.value));
    default:
      return verify_values(check, header, reinterpret_cast<const std::int16_t*>(view.value));
  }
}

}  // namespace

bool verify_couplings(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require(section.bytes >= sizeof(CouplingsHeader), VerifyRule::section_size, "bytes", 0,
                     static_cast<double>(section.bytes), sizeof(CouplingsHeader))) {
    return false;
  }
  const auto& header = *section.as<CouplingsHeader>();
  const Expected expected(section, context.view);
  if (!verify_header(check, header, expected) ||
      !check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(header.reserved))),
                     VerifyRule::reserved_not_zero, "reserved", 0, 1, 0)) {
    return false;
  }
  const Extent extent(header);
  if (!verify_extent(check, section, header, extent) || !verify_gaps(check, section, extent)) return false;

  const CouplingsView view{
      header.columns,
      header.rows,
      header.value_bits,
      header.index_bytes,
      header.quantum,
      reinterpret_cast<const std::uint32_t*>(section.data + header.begin_offset),
      header.index_bytes == 0 ? nullptr : static_cast<const void*>(section.data + header.index_offset),
      section.data + header.value_offset};
  if (!verify_blocks(check, view, header, expected)) return false;
  context.kept_blocks += header.block_count;
  context.view.level[section.a].couplings[section.b / layout::strengths][section.b % layout::strengths] = view;
  return true;
}

}  // namespace greenloop
