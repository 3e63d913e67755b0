#pragma once

#include "offline/report/build_record.hpp"
#include "offline/report/figure.hpp"

namespace greenloop::offline {

/// Size of the model cut off after each constraint level and work of a step resolved there, over each error of that
/// level: a row of two panels a level, of what the build tried, the chosen one ringed. A panel without two points is
/// left empty; has_level_frontiers(record) holds.
[[nodiscard]] Figure level_frontiers_figure(const BuildRecord& record);

/// Whether a level has two points.
[[nodiscard]] bool has_level_frontiers(const BuildRecord& record);

}  // namespace greenloop::offline
