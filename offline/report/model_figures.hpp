#pragma once

#include <vector>

#include "offline/report/build_record.hpp"
#include "offline/report/figure.hpp"
#include "offline/report/model_facts.hpp"

namespace greenloop::offline {

/// Where the file's bytes go, by kind of section.
[[nodiscard]] Figure bytes_figure(const std::vector<KindBytes>& kinds);

/// Speed and size against error over the threshold, the chosen one marked; a side without data is left out.
/// `record.curve` has at least two points, and some of them work or bytes.
[[nodiscard]] Figure error_figure(const BuildRecord& record);

/// Whether error_figure has something to show.
[[nodiscard]] bool has_error_curve(const BuildRecord& record);

/// Seconds of each stage of the build; `stages` is not empty.
[[nodiscard]] Figure stages_figure(const std::vector<StageTime>& stages);

}  // namespace greenloop::offline
