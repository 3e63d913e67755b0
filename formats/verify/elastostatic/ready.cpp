#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/ready/base_columns.hpp"
#include "formats/stored_blocks.hpp"
#include "formats/verify/elastostatic/sections.hpp"

namespace greenloop::elastostatic {
namespace {

using layout::BaseColumnsHeader;

bool verify_header(SectionCheck& check, const BaseColumnsHeader& header, const BaseColumns& base) {
  std::uint32_t mask = 0;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    mask |= base.holds[layer] ? 1U << layer : 0U;
  }
  return check.require_equal("columns", 0, header.columns, base.columns) &&
         check.require_equal("tiles", 0, header.tiles, base.tiles) &&
         check.require_equal("layer_mask", 0, header.layer_mask, mask);
}

// the stored blocks of a coefficient in the rows of level 0, one row after the other, as elements of their transposes
template <unsigned N>
class BaseRows {
 public:
  BaseRows(const BaseColumns& base, const LevelView& level, std::uint32_t column) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = level.couplings[layer];
      couplings_[layer] = &couplings;
      const bool held = base.holds[layer] && couplings.columns > 0;
      next_[layer] = held ? couplings.begin[column] : 0;
      end_[layer] = held ? couplings.begin[column + 1] : 0;
    }
  }

  // of the next row
  void take(std::uint32_t row, int (&element)[N * N]) {
    for (int& one : element) one = 0;
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      if (next_[layer] == end_[layer] || stored_row(*couplings_[layer], next_[layer]) != row) continue;
      for (std::uint32_t k = 0; k < N * N; ++k) {
        element[N * (k % N) + k / N] += stored_value<N>(*couplings_[layer], layout::value_bits[layer], next_[layer], k);
      }
      ++next_[layer];
    }
  }

 private:
  const CouplingsView* couplings_[layout::layers];
  std::uint32_t next_[layout::layers], end_[layout::layers];
};

template <unsigned N>
bool verify_column(SectionCheck& check, const BaseColumns& base, BaseRows<N> rows, std::uint32_t place) {
  const std::size_t tile = place / BaseColumns::width, lane = place % BaseColumns::width;
  for (std::uint32_t row = 0; row < base.columns; ++row) {
    int element[N * N];
    rows.take(row, element);
    const std::byte* const found = base.column<N>(row) + BaseColumns::tile_bytes<N> * tile;
    for (std::uint32_t k = 0; k < N * N; ++k) {
      const std::byte& at = found[std::size_t{BaseColumns::width} * k + lane];
      const auto right = static_cast<std::byte>(element[k]);
      if (!check.require(at == right, VerifyRule::inconsistent, "value", static_cast<std::uint64_t>(&at - base.value),
                         std::to_integer<int>(at), std::to_integer<int>(right))) {
        return false;
      }
    }
  }
  return true;
}

// a tile may reach beyond the last coefficient
template <unsigned N>
bool verify_rest(SectionCheck& check, const BaseColumns& base, std::uint32_t end) {
  for (std::uint32_t place = end; base.columns > 0 && place < BaseColumns::width * base.tiles; ++place) {
    if (!verify_column<N>(check, base, BaseRows<N>({}, {}, 0), place)) return false;
  }
  return true;
}

template <unsigned N>
bool verify_values(SectionCheck& check, const ElastostaticView& view, const BaseColumns& base) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      if (!verify_column<N>(check, base, BaseRows<N>(base, level, i), level.domain_begin + i)) return false;
    }
  }
  return verify_rest<N>(check, base, view.domain_count);
}

// what follows the header
template <unsigned N>
bool verify_body(SectionCheck& check, const Section& section, const ElastostaticView& view, const BaseColumns& base) {
  const std::uint64_t bytes = sizeof(BaseColumnsHeader) + value_bytes<N>(base);
  return check.require(section.bytes == bytes, VerifyRule::section_size, "bytes", 0, static_cast<double>(section.bytes),
                       static_cast<double>(bytes)) &&
         verify_values<N>(check, view, base);
}

}  // namespace

// A node that is read moves with its own coefficient at least. With which others is for a loop to check: it takes
// memory, which a verifier has none of.
bool verify_read_marks(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  ElastostaticView& view = context.view;
  const auto* read = section.as<std::uint8_t>();
  if (!check.require_count(view.domain_count)) return false;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      const std::uint32_t place = level.domain_begin + i;
      const bool asked = (level.nodes[i].flags & layout::node_read) != 0;
      if (!check.require_at_most("read", place, read[place], 1) ||
          !check.require(read[place] == 1 || !asked, VerifyRule::inconsistent, "read", place, read[place], 1)) {
        return false;
      }
    }
  }
  view.ready.read = read;
  return true;
}

bool verify_base_columns(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  ElastostaticView& view = context.view;
  if (!check.require_bytes(sizeof(BaseColumnsHeader))) return false;
  const auto& header = *section.as<BaseColumnsHeader>();
  BaseColumns base = base_columns_of(view);
  base.value = section.data + sizeof(header);
  if (!verify_header(check, header, base) ||
      !check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(header.reserved))),
                     VerifyRule::reserved_not_zero, "reserved", 0, 1, 0)) {
    return false;
  }
  if (!(view.info->components == 1 ? verify_body<1>(check, section, view, base)
                                   : verify_body<3>(check, section, view, base))) {
    return false;
  }
  view.ready.base = base;
  return true;
}

}  // namespace greenloop::elastostatic
