#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/ready/mirrored_couplings.hpp"
#include "formats/stored_blocks.hpp"
#include "formats/verify/elastostatic/sections.hpp"

namespace greenloop::elastostatic {
namespace {

using layout::CouplingsHeader;

// What the place of a section says about it.
struct Expected {
  std::uint32_t columns, rows, value_bits, components;
  bool mirrored;  // rows after the column instead of before

  Expected(const Section& section, const ElastostaticView& view)
      : columns(view.level[section.a].counts->domain_count),
        rows(domain_of_mesh(view, section.a)),
        value_bits(layout::value_bits[section.b]),
        components(view.info->components),
        mirrored(false) {}
  Expected(std::uint32_t layer, const ElastostaticView& view)
      : columns(view.domain_count),
        rows(view.domain_count),
        value_bits(layout::value_bits[layer]),
        components(view.info->components),
        mirrored(true) {}

  // the blocks there can be
  [[nodiscard]] std::uint64_t all_blocks() const {
    const std::uint64_t before = rows - columns;
    return columns == 0 ? 0 : columns * before + std::uint64_t{columns} * (columns - 1) / 2;
  }
  [[nodiscard]] std::uint32_t first_row(std::uint32_t column) const { return mirrored ? column + 1 : 0; }
  [[nodiscard]] std::uint32_t end_row(std::uint32_t column) const { return mirrored ? rows : rows - columns + column; }
  [[nodiscard]] std::uint32_t rows_of(std::uint32_t column) const { return end_row(column) - first_row(column); }
  [[nodiscard]] std::uint64_t values_per_block() const { return std::uint64_t{components} * components; }
  [[nodiscard]] std::uint64_t bytes_per_block() const { return layout::block_bytes(components, value_bits); }
};

// Where the arrays must stand. No overflow: columns and block_count are below 2^32, the other factors at most 18.
struct Extent {
  std::uint64_t begin_end, index, index_end, value, value_end;

  Extent(const CouplingsHeader& header, const Expected& expected)
      : begin_end(sizeof(CouplingsHeader) + (std::uint64_t{header.columns} + 1) * sizeof(std::uint32_t)),
        index(layout::aligned(begin_end)),
        index_end(index + header.block_count * header.index_bytes),
        value(layout::aligned(index_end)),
        value_end(value + header.block_count * expected.bytes_per_block()) {}
};

bool verify_header(SectionCheck& check, const CouplingsHeader& header, const Expected& expected) {
  const auto is = [&](const char* field, std::uint32_t value, std::uint32_t right) {
    return check.require(value == right, VerifyRule::inconsistent, field, 0, value, right);
  };
  const std::uint64_t most = std::min(expected.all_blocks(), std::uint64_t{layout::none});
  return is("columns", header.columns, header.block_count > 0 ? expected.columns : 0) &&
         is("rows", header.rows, expected.rows) && verify_index_bytes(check, header.index_bytes, header.rows) &&
         check.require(header.block_count <= most, VerifyRule::out_of_range, "block_count", 0,
                       static_cast<double>(header.block_count), static_cast<double>(most));
}

bool verify_extent(SectionCheck& check, const CouplingsHeader& header, const Extent& extent) {
  return check.require_offset("begin_offset", header.begin_offset, sizeof(CouplingsHeader)) &&
         check.require_offset("index_offset", header.index_offset, extent.index) &&
         check.require_offset("value_offset", header.value_offset, extent.value) &&
         check.require_bytes(extent.value_end + layout::tail_bytes);
}

bool verify_gaps(SectionCheck& check, const Section& section, const Extent& extent) {
  return check.require_zero(extent.begin_end, extent.index) && check.require_zero(extent.index_end, extent.value) &&
         check.require_zero(extent.value_end, section.bytes);
}

bool verify_begin(SectionCheck& check, const CouplingsHeader& header, const Expected& expected,
                  const std::uint32_t* begin) {
  if (!check.require(begin[0] == 0, VerifyRule::inconsistent, "begin", 0, begin[0], 0)) return false;
  for (std::uint32_t j = 0; j < header.columns; ++j) {
    if (!check.require(begin[j + 1] >= begin[j], VerifyRule::not_increasing, "begin", j + 1u, begin[j + 1], begin[j])) {
      return false;
    }
    const std::uint32_t kept = begin[j + 1] - begin[j], most = expected.rows_of(j);
    if (!check.require(kept <= most, VerifyRule::inconsistent, "begin", j + 1u, begin[j + 1],
                       static_cast<double>(std::uint64_t{begin[j]} + most))) {
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
      if (!check.require(index[b] < expected.end_row(j), VerifyRule::out_of_range, "index", b, index[b],
                         expected.end_row(j) - 1.0) ||
          !check.require(index[b] >= expected.first_row(j), VerifyRule::out_of_range, "index", b, index[b],
                         expected.first_row(j)) ||
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
bool verify_values(SectionCheck& check, std::uint64_t count, const Value* value) {
  constexpr Value forbidden = std::numeric_limits<Value>::min();
  const Value* found = std::find(value, value + count, forbidden);
  return check.require(found == value + count, VerifyRule::out_of_range, "value",
                       static_cast<std::uint64_t>(found - value), forbidden, forbidden + 1);
}

// the elements of a block are odd in number: the last byte's high half is none
bool verify_nibbles(SectionCheck& check, const CouplingsHeader& header, const Expected& expected,
                    const std::byte* value) {
  const std::uint64_t elements = expected.values_per_block(), bytes = expected.bytes_per_block();
  for (std::uint64_t b = 0; b < header.block_count; ++b, value += bytes) {
    for (std::uint64_t k = 0; k < elements; ++k) {
      const auto nibble = std::to_integer<std::uint32_t>(value[k / 2]) >> (4 * (k % 2)) & 15U;
      if (!check.require(nibble != 8, VerifyRule::out_of_range, "value", elements * b + k, -8, -7)) return false;
    }
    const auto behind = std::to_integer<std::uint32_t>(value[bytes - 1]) >> 4U;
    if (!check.require(behind == 0, VerifyRule::padding_not_zero, "value", elements * (b + 1) - 1, behind, 0)) {
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
  const std::uint64_t values = expected.values_per_block() * header.block_count;
  switch (expected.value_bits) {
    case 4:
      return verify_nibbles(check, header, expected, view.value);
    case 8:
      return verify_values(check, values, reinterpret_cast<const std::int8_t*>(view.value));
    default:
      return verify_values(check, values, reinterpret_cast<const std::int16_t*>(view.value));
  }
}

// all of a section but what its blocks are of; fills `view`
bool verify_arrays(const Section& section, const Expected& expected, VerifyContext& context, CouplingsView& view) {
  SectionCheck check(section, context.result);
  if (!check.require_bytes(sizeof(CouplingsHeader))) return false;
  const auto& header = *section.as<CouplingsHeader>();
  if (!verify_header(check, header, expected) ||
      !check.require(
          !context.reserved_is_zero || (header.reserved0 == 0 && all_zero(std::as_bytes(std::span(header.reserved)))),
          VerifyRule::reserved_not_zero, "reserved", 0, 1, 0)) {
    return false;
  }
  const Extent extent(header, expected);
  if (!verify_extent(check, header, extent) || !verify_gaps(check, section, extent)) return false;
  view = {header.columns,
          header.rows,
          header.index_bytes,
          reinterpret_cast<const std::uint32_t*>(section.data + header.begin_offset),
          static_cast<const void*>(section.data + header.index_offset),
          section.data + header.value_offset};
  return verify_blocks(check, view, header, expected);
}

// Some columns of a level, and the first of the stored blocks of each that no mirrored one was compared with. Mirrored
// blocks by columns meet the stored ones of each column by rows.
struct Window {
  static constexpr std::uint32_t most = 512;
  const LevelView& level;
  const CouplingsView& couplings;  // of a layer
  std::uint32_t first, end;        // places
  std::uint32_t next[most];

  Window(const ElastostaticView& view, std::uint32_t q, std::uint32_t layer, std::uint32_t begin)
      : level(view.level[q]),
        couplings(level.couplings[layer]),
        first(begin),
        end(std::min(begin + most, domain_of_mesh(view, q))) {
    const std::uint32_t first_row = view.ready.base.holds[layer] ? view.ready.base.columns : 0;
    for (std::uint32_t place = first; place < end; ++place) {
      std::uint32_t position = end_of(place);
      if (view.ready.read[place] != 0) {
        visit_rows(couplings, place - level.domain_begin, first_row, place,
                   [&](std::uint32_t, std::uint32_t at) { position = std::min(position, at); });
      }
      next[place - first] = position;
    }
  }

  [[nodiscard]] std::uint32_t end_of(std::uint32_t place) const {
    return couplings.columns == 0 ? 0 : couplings.begin[place - level.domain_begin + 1];
  }
  // whether the next block of a column is in this row
  [[nodiscard]] bool is_next(std::uint32_t place, std::uint32_t row) const {
    const std::uint32_t position = next[place - first];
    return position < end_of(place) && stored_row(couplings, position) == row;
  }
};

template <unsigned N, std::uint32_t bits>
bool is_transposed(const CouplingsView& mirrored, std::uint32_t b, const CouplingsView& couplings,
                   std::uint32_t position) {
  int difference = 0;
  for (std::uint32_t k = 0; k < N * N; ++k) {
    difference |=
        stored_value<N>(mirrored, bits, b, k) ^ stored_value<N>(couplings, bits, position, N * (k % N) + k / N);
  }
  return difference == 0;
}

template <unsigned N>
bool is_transposed(std::uint32_t bits, const CouplingsView& mirrored, std::uint32_t b, const CouplingsView& couplings,
                   std::uint32_t position) {
  switch (bits) {
    case 4:
      return is_transposed<N, 4>(mirrored, b, couplings, position);
    case 8:
      return is_transposed<N, 8>(mirrored, b, couplings, position);
    default:
      return is_transposed<N, 16>(mirrored, b, couplings, position);
  }
}

template <unsigned N>
bool verify_window(SectionCheck& check, std::uint32_t bits, const CouplingsView& mirrored, Window& window) {
  bool right = true;
  for (std::uint32_t j = 0; right && j < std::min(mirrored.columns, window.end); ++j) {
    visit_rows(mirrored, j, window.first, window.end, [&](std::uint32_t row, std::uint32_t b) {
      right = right && check.require(window.is_next(row, j), VerifyRule::inconsistent, "index", b, row, layout::none) &&
              check.require(is_transposed<N>(bits, mirrored, b, window.couplings, window.next[row - window.first]++),
                            VerifyRule::inconsistent, "value", std::uint64_t{N} * N * b, row, layout::none);
    });
  }
  return right;
}

// The mirrored blocks are distinct and as many as there have to be: all of them, if each is one of those. Work: linear
// in the blocks and, for every 512 coefficients, in the coefficients, times the logarithm of a column's length.
template <unsigned N>
bool verify_mirror(SectionCheck& check, const ElastostaticView& view, std::uint32_t layer,
                   const CouplingsView& mirrored) {
  const std::uint64_t blocks = count_mirrored(view, layer, view.ready.base, view.ready.read);
  if (!check.require(block_count(mirrored) == blocks, VerifyRule::inconsistent, "block_count", 0, block_count(mirrored),
                     static_cast<double>(blocks))) {
    return false;
  }
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t first = view.level[q].domain_begin; first < domain_of_mesh(view, q); first += Window::most) {
      Window window(view, q, layer, first);
      if (!verify_window<N>(check, layout::value_bits[layer], mirrored, window)) return false;
    }
  }
  return true;
}

}  // namespace

bool verify_couplings(const Section& section, VerifyContext& context) {
  CouplingsView view;
  if (!verify_arrays(section, Expected(section, context.view), context, view)) return false;
  context.kept_blocks += block_count(view);
  context.view.level[section.a].couplings[section.b] = view;
  return true;
}

bool verify_mirrored_couplings(const Section& section, VerifyContext& context) {
  const std::uint32_t layer = section.a;
  CouplingsView& view = context.view.ready.mirrored.layer[layer];
  SectionCheck check(section, context.result);
  return verify_arrays(section, Expected(layer, context.view), context, view) &&
         (context.view.info->components == 1 ? verify_mirror<1>(check, context.view, layer, view)
                                             : verify_mirror<3>(check, context.view, layer, view));
}

}  // namespace greenloop::elastostatic
