#include <cstring>

#include "formats/verify/elastostatic/sections.hpp"

namespace greenloop::elastostatic {
namespace {

using layout::LoadKind;
using layout::LoadRecord;

std::uint32_t number(LoadKind kind) { return static_cast<std::uint32_t>(kind); }

// the accelerations stand first, all or none, then pressures
std::uint32_t expected_kind(const LoadRecord* records, std::uint32_t i) {
  const bool accelerated = records[0].kind == number(LoadKind::acceleration_x);
  return accelerated && i < layout::accelerations ? number(LoadKind::acceleration_x) + i : number(LoadKind::pressure);
}

// letters, then zeros to the end
bool verify_name(SectionCheck& check, const LoadRecord& record, std::uint32_t i) {
  const bool named = record.kind == number(LoadKind::pressure);
  if (!check.require((record.name[0] != 0) == named, VerifyRule::inconsistent, "name", i, record.name[0],
                     named ? 1 : 0)) {
    return false;
  }
  bool ended = false;
  for (const char letter : record.name) {
    ended = ended || letter == 0;
    const bool right = ended ? letter == 0 : letter >= ' ' && letter <= '~';
    if (!check.require(right, VerifyRule::out_of_range, "name", i, letter, '~')) return false;
  }
  return check.require(ended, VerifyRule::out_of_range, "name", i, sizeof(record.name), sizeof(record.name) - 1);
}

bool verify_distinct(SectionCheck& check, const LoadRecord* records, std::uint32_t i) {
  if (records[i].kind != number(LoadKind::pressure)) return true;
  for (std::uint32_t k = 0; k < i; ++k) {
    if (!check.require(std::memcmp(records[k].name, records[i].name, sizeof(records[i].name)) != 0,
                       VerifyRule::inconsistent, "name", i, i, k)) {
      return false;
    }
  }
  return true;
}

bool verify_load(SectionCheck& check, const LoadRecord* records, std::uint32_t i) {
  const LoadRecord& record = records[i];
  const std::uint32_t expected = expected_kind(records, i);
  if (!check.require(record.kind >= 1 && record.kind <= layout::load_kinds, VerifyRule::bad_enum, "kind", i,
                     record.kind, layout::load_kinds) ||
      !check.require(record.kind == expected, VerifyRule::inconsistent, "kind", i, record.kind, expected)) {
    return false;
  }
  for (const float force : record.resultant) {
    if (!check.require_finite("resultant", i, force)) return false;
  }
  return verify_name(check, record, i) && verify_distinct(check, records, i);
}

}  // namespace

bool verify_loads(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t count = context.view.info->loads;
  const auto* records = section.as<LoadRecord>();
  if (!check.require_count(count)) return false;
  if (records[0].kind == number(LoadKind::acceleration_x) &&
      !check.require(count >= layout::accelerations, VerifyRule::inconsistent, "kind", 0, count,
                     layout::accelerations)) {
    return false;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!verify_load(check, records, i)) return false;
  }
  context.view.loads = {records, count};
  return true;
}

bool verify_load_columns(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  LevelView& level = context.view.level[section.a];
  const std::uint64_t count = std::uint64_t{context.view.info->loads} * level.counts->domain_count;
  const auto* numbers = section.as<float>();
  if (!check.require_count(count)) return false;
  for (std::uint64_t i = 0; i < 3 * count; ++i) {
    if (!check.require_finite("column", i, numbers[i])) return false;
  }
  level.load_columns = numbers;
  return true;
}

}  // namespace greenloop::elastostatic
