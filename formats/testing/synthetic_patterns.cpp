#include "formats/testing/synthetic_model.hpp"

namespace greenloop {
namespace {

layout::PatternRecord record(layout::PatternKind kind, std::uint32_t contacts, float least) {
  layout::PatternRecord result{};
  result.kind = static_cast<std::uint32_t>(kind);
  result.contacts = contacts;
  result.samples = 10 + contacts;
  const auto rise = [&least](float(&error)[3]) {
    for (float& value : error) value = least *= 1.25F;
  };
  rise(result.field_error);
  rise(result.field_peak);
  rise(result.force_error);
  if (layout::has_total_force(kind)) rise(result.total_force_error);
  return result;
}

}  // namespace

std::vector<layout::PatternRecord> synthetic_patterns() {
  return {record(layout::PatternKind::node, 1, 0.001F), record(layout::PatternKind::patch, 4, 0.002F),
          record(layout::PatternKind::patch, 16, 0.003F), record(layout::PatternKind::turned, 16, 0.004F),
          record(layout::PatternKind::pinch, 64, 0.005F)};
}

}  // namespace greenloop
