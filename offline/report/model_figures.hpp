#pragma once

#include <vector>

#include "offline/report/build_record.hpp"
#include "offline/report/figure.hpp"
#include "offline/report/model_facts.hpp"

namespace greenloop::offline {

/// Where the file's bytes go, by kind of section.
[[nodiscard]] Figure bytes_figure(const std::vector<KindBytes>& kinds);

/// Size over RMS error and over patch force error, work of a step over patch force error: what the build tried, the
/// chosen one ringed. A panel of fewer than two points is left out; has_frontier(record) holds.
[[nodiscard]] Figure frontier_figure(const BuildRecord& record);

/// Whether frontier_figure has something to show.
[[nodiscard]] bool has_frontier(const BuildRecord& record);

/// The errors of each constraint level; has_level_errors(levels) holds.
[[nodiscard]] Figure level_errors_figure(const std::vector<LevelErrors>& levels);

/// Whether any error is above zero.
[[nodiscard]] bool has_level_errors(const std::vector<LevelErrors>& levels);

/// Seconds of each stage of the build; `stages` is not empty.
[[nodiscard]] Figure stages_figure(const std::vector<StageTime>& stages);

}  // namespace greenloop::offline
