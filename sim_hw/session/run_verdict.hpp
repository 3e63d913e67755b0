#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sim_hw/control_loop/cycle_tally.hpp"
#include "sim_hw/device/command_arrival.hpp"
#include "sim_hw/guard/time_histogram.hpp"
#include "sim_hw/guard/time_verdict.hpp"
#include "sim_hw/session/link.hpp"

namespace greenloop {

// What the verdicts of contacts, of motions and of dragged bodies have in common.

/// Of the cycles' processor times, µs: bins of a microsecond up to the period, beyond which every time is late.
[[nodiscard]] TimeHistogram histogram(const std::vector<float>& cpu_us, double rate);

/// Every cycle was run, and both sides agree on what was sent.
[[nodiscard]] bool is_complete(const LinkResult& result, const LinkSummary& device, const CycleTally& tally);

/// 16 hexadecimal digits.
[[nodiscard]] std::string digest_text(const LinkResult& result);

/// What a run came to, and where it stands in every JSON: from `passed` to `worst_work`.
[[nodiscard]] nlohmann::ordered_json opening_json(bool passed, bool held, const TimeVerdict& time,
                                                  std::string_view script, double seconds, const LinkResult& result,
                                                  const LinkSummary& device, const CycleTally& tally);

/// Adds times and transport, and last why a run did not come to its end.
void add_transport(const TimeVerdict& time, const LinkResult& result, const LinkSummary& device,
                   nlohmann::ordered_json& json);
void add_reasons(const LinkResult& result, nlohmann::ordered_json& json);

/// "HELD: 1000 of 1000 cycles at 1000 Hz, ...", a line.
[[nodiscard]] std::string headline(bool held, const LinkResult& result, const LinkSummary& device,
                                   const CycleTally& tally);

/// Work of the cycles against the budget, a line.
[[nodiscard]] std::string work_line(const LinkResult& result, const CycleTally& tally);

/// Digest, transport, the first miss, and why a run did not come to its end.
[[nodiscard]] std::string ending(bool complete, const LinkResult& result, const LinkSummary& device,
                                 const CycleTally& tally);

}  // namespace greenloop
