#include "formats/verify/elastostatic/sections.hpp"

namespace greenloop::elastostatic {
namespace {

using layout::PatternKind;
using layout::PatternRecord;

constexpr std::uint64_t most_records = std::uint64_t{layout::pattern_kinds} * layout::most_pattern_contacts;

// three quantiles: finite, not negative, none below the one before
bool verify_quantiles(SectionCheck& check, const char* field, std::uint32_t i, const float (&error)[3]) {
  double least = 0;
  for (const float value : error) {
    if (!check.require_at_least(field, i, value, least)) return false;
    least = value;
  }
  return true;
}

bool verify_contacts(SectionCheck& check, const PatternRecord& record, std::uint32_t i) {
  const std::uint32_t least = layout::least_contacts(static_cast<PatternKind>(record.kind));
  return check.require_at_least("contacts", i, record.contacts, least) &&
         check.require_at_most("contacts", i, record.contacts, layout::most_pattern_contacts) &&
         check.require_at_least("samples", i, record.samples, 1);
}

bool verify_pattern(SectionCheck& check, const PatternRecord& record, std::uint32_t i, bool reserved_is_zero) {
  const bool known = record.kind >= 1 && record.kind <= layout::pattern_kinds;
  if (!check.require(known, VerifyRule::bad_enum, "kind", i, record.kind, layout::pattern_kinds) ||
      !verify_contacts(check, record, i) ||
      !check.require(!reserved_is_zero || record.reserved == 0, VerifyRule::reserved_not_zero, "reserved", i,
                     record.reserved, 0) ||
      !verify_quantiles(check, "field_error", i, record.field_error) ||
      !verify_quantiles(check, "field_peak", i, record.field_peak) ||
      !verify_quantiles(check, "force_error", i, record.force_error) ||
      !verify_quantiles(check, "total_force_error", i, record.total_force_error)) {
    return false;
  }
  const float worst_total = record.total_force_error[2];
  return check.require(worst_total == 0 || layout::has_total_force(static_cast<PatternKind>(record.kind)),
                       VerifyRule::inconsistent, "total_force_error", i, worst_total, 0);
}

bool comes_before(const PatternRecord& a, const PatternRecord& b) {
  return a.kind < b.kind || (a.kind == b.kind && a.contacts < b.contacts);
}

}  // namespace

bool verify_patterns(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint64_t count = section.bytes / sizeof(PatternRecord);
  const auto* records = section.as<PatternRecord>();
  if (!check.require_count(count) ||
      !check.require(count <= most_records, VerifyRule::section_size, "bytes", 0, static_cast<double>(section.bytes),
                     static_cast<double>(most_records * sizeof(PatternRecord)))) {
    return false;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!verify_pattern(check, records[i], i, context.reserved_is_zero)) return false;
    if (i > 0 && !check.require(comes_before(records[i - 1], records[i]), VerifyRule::not_increasing, "contacts", i,
                                records[i].contacts, records[i - 1].contacts)) {
      return false;
    }
  }
  context.view.level[section.a].patterns = {records, static_cast<std::size_t>(count)};
  return true;
}

}  // namespace greenloop::elastostatic
