#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <iterator>
#include <string>

#include "rt_tests/harness/driver.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop {

/// The tools on Elastostatic: see Driver.
struct ElastostaticDriver {
  using Solver = Elastostatic;
  using StepReport = Elastostatic::StepReport;

  static constexpr Elastostatic::Limits limits(std::uint32_t contacts, std::uint32_t sets, const Prices& prices = {}) {
    return {.max_contacts = contacts, .cached_factors = sets, .prices = prices};
  }

  static ScriptBounds bounds(const Elastostatic::Limits& limits, const Elastostatic::Requirement& need) {
    return {.contacts = limits.max_contacts,
            .sets = limits.cached_factors,
            .least_work = need.least_work,
            .worst_work = *std::max_element(std::begin(need.worst_work), std::end(need.worst_work))};
  }

  static std::uint64_t declared_work(const Elastostatic::Requirement& need, const StepReport& report) {
    return need.worst_work[report.constraint_level];
  }

  static void count(const StepReport& report, const StepReport& last, AnswerCounts& counts) {
    ++counts.by_status[static_cast<std::size_t>(report.status)];
    counts.work += report.work;
    counts.worst_work = std::max(counts.worst_work, report.work);
    if (!answered(report.status)) {
      return;
    }
    const Elastostatic::StepDetails& details = report.details;
    ++counts.by_level[report.constraint_level];
    counts.cached += details.cached_factor ? 1 : 0;
    counts.changed += details.changed_nodes > 0 ? 1 : 0;
    counts.waiting += details.waiting_contacts > 0 ? 1 : 0;
    const bool finer = report.constraint_level > last.constraint_level;
    counts.refined += finer && last.details.pending_work > 0 && details.cached_factor ? 1 : 0;
  }

  static std::string way(const StepReport& report, bool with_field) {
    const Elastostatic::StepDetails& details = report.details;
    if (details.held_contacts == 0) {
      return with_field ? "released, field" : "released";
    }
    std::string way = details.cached_factor ? "cached" : details.changed_nodes > 0 ? "changed" : "fresh";
    way += details.waiting_contacts > 0 ? ", waiting" : "";
    way += details.pending_work > 0 ? ", preparing" : "";
    return way + (with_field ? ", field" : "");
  }

  static std::array<std::uint64_t, 6> facts(const StepReport& report) {
    return {static_cast<std::uint64_t>(report.status),
            report.constraint_level,
            report.constraint_level,
            report.details.held_contacts,
            report.field_level,
            report.work};
  }

  static std::array<std::uint64_t, 7> all_facts(const StepReport& report) {
    const Elastostatic::StepDetails& details = report.details;
    return {static_cast<std::uint64_t>(report.status) << 32 | report.constraint_level << 8 | report.field_level,
            std::uint64_t{report.constraint_level} << 32 | details.held_contacts,
            report.work << 1 | (details.cached_factor ? 1 : 0),
            std::bit_cast<std::uint32_t>(details.glide),
            std::bit_cast<std::uint32_t>(details.level_difference),
            std::bit_cast<std::uint64_t>(details.switch_work),
            details.pending_work};
  }
};
static_assert(Driver<ElastostaticDriver>);

}  // namespace greenloop
