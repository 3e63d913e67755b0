#include <cmath>

#include "formats/verify/elastostatic/sections.hpp"

namespace greenloop::elastostatic {
namespace {

using layout::VertexRecord;

constexpr double most_rounding = 1e-6;  // of a sum of three weights

bool verify_corners(SectionCheck& check, const VertexRecord& record, std::uint64_t i, std::uint32_t node_count) {
  for (std::uint64_t k = 0; k < 3; ++k) {
    const std::uint32_t node = record.node[k], before = record.node[(k + 2) % 3];
    if (!check.require(node < node_count, VerifyRule::out_of_range, "node", 3 * i + k, node, node_count) ||
        !check.require(node != before, VerifyRule::inconsistent, "node", 3 * i + k, node, before)) {
      return false;
    }
  }
  return true;
}

bool verify_weights(SectionCheck& check, const VertexRecord& record, std::uint64_t i) {
  double sum = 0;
  for (std::uint64_t k = 0; k < 3; ++k) {
    const double weight = record.weight[k];
    if (!check.require_at_least("weight", 3 * i + k, weight, 0) ||
        !check.require_at_most("weight", 3 * i + k, weight, 1)) {
      return false;
    }
    sum += weight;
  }
  return check.require(std::fabs(sum - 1) <= most_rounding, VerifyRule::inconsistent, "weight", 3 * i, sum, 1);
}

}  // namespace

bool verify_vertex_map(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  ElastostaticView& view = context.view;
  const std::uint64_t count = section.bytes / sizeof(VertexRecord);
  const auto* records = section.as<VertexRecord>();
  if (!check.require_equal("levels", 0, view.levels, view.info->levels) || !check.require_bytes(sizeof(VertexRecord)) ||
      !check.require_count(count)) {
    return false;
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!verify_corners(check, records[i], i, view.node_count) || !verify_weights(check, records[i], i)) return false;
  }
  view.vertices = {records, static_cast<std::size_t>(count)};
  return true;
}

}  // namespace greenloop::elastostatic
