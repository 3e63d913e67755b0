#include <algorithm>
#include <limits>

#include "formats/verify/elastostatic/sections.hpp"

namespace greenloop::elastostatic {
namespace {

using layout::PredictionsHeader;

std::uint64_t blocks(const PredictionsHeader& header) { return std::uint64_t{header.nodes} * header.terms; }

bool verify_header(SectionCheck& check, const PredictionsHeader& header, std::uint32_t nodes, std::uint32_t rows) {
  return check.require(header.nodes == nodes, VerifyRule::inconsistent, "nodes", 0, header.nodes, nodes) &&
         check.require(header.terms <= layout::most_prediction_terms, VerifyRule::out_of_range, "terms", 0,
                       header.terms, layout::most_prediction_terms) &&
         check.require(header.rows == rows, VerifyRule::inconsistent, "rows", 0, header.rows, rows) &&
         verify_index_bytes(check, header.index_bytes, header.rows);
}

bool verify_extent(SectionCheck& check, const Section& section, const PredictionsHeader& header,
                   const layout::PredictionsExtent& extent) {
  return check.require_offset("index_offset", header.index_offset, extent.index) &&
         check.require_offset("weight_offset", header.weight_offset, extent.weight) &&
         check.require_bytes(extent.weight_end + layout::tail_bytes) &&
         check.require_zero(extent.index_end, extent.weight) && check.require_zero(extent.weight_end, section.bytes);
}

template <class Index>
bool verify_index(SectionCheck& check, const PredictionsHeader& header, const Index* index) {
  for (std::uint64_t k = 0; k < blocks(header); ++k) {
    if (!check.require(index[k] < header.rows, VerifyRule::out_of_range, "index", k, index[k], header.rows - 1.0)) {
      return false;
    }
  }
  return true;
}

// the most negative value has no counterpart
bool verify_weights(SectionCheck& check, std::uint64_t count, const std::int16_t* weight) {
  constexpr std::int16_t forbidden = std::numeric_limits<std::int16_t>::min();
  const std::int16_t* const end = weight + count;
  const std::int16_t* const found = std::find(weight, end, forbidden);
  return check.require(found == end, VerifyRule::out_of_range, "weight", static_cast<std::uint64_t>(found - weight),
                       forbidden, forbidden + 1);
}

}  // namespace

bool verify_predictions(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_bytes(sizeof(PredictionsHeader))) return false;
  const auto& header = *section.as<PredictionsHeader>();
  LevelView& level = context.view.level[section.a];
  if (!verify_header(check, header, level.counts->domain_count, level.domain_begin) ||
      !check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(header.reserved))),
                     VerifyRule::reserved_not_zero, "reserved", 0, 1, 0)) {
    return false;
  }
  const std::uint32_t components = context.view.info->components;
  const layout::PredictionsExtent extent(header, components);
  if (!verify_extent(check, section, header, extent)) return false;
  const std::byte* const index = section.data + extent.index;
  const bool indices_right = header.index_bytes == 2
                                 ? verify_index(check, header, reinterpret_cast<const std::uint16_t*>(index))
                                 : verify_index(check, header, reinterpret_cast<const std::uint32_t*>(index));
  const std::byte* const weight = section.data + extent.weight;
  const std::uint64_t weights = blocks(header) * components * components;
  if (!indices_right || !verify_weights(check, weights, reinterpret_cast<const std::int16_t*>(weight))) return false;
  level.predictions = {header.terms, header.index_bytes, index, weight};
  return true;
}

}  // namespace greenloop::elastostatic
