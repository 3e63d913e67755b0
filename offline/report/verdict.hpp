#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/write/model_file.hpp"
#include "offline/report/build_record.hpp"
#include "offline/report/trace.hpp"

namespace greenloop::offline {

/// One thing that was asked for, and what is reached.
struct Judgement {
  std::string what;
  std::string asked;  ///< "–": nothing
  std::string reached;
  std::optional<bool> held = {};  ///< none: not judged
};

/// Whether a model, and a run with it if there was one, is good enough for its scene.
struct Verdict {
  std::optional<bool> good;  ///< none: the scene is not known
  std::string sentence;
  std::vector<Judgement> rows;
};

/// Judges compression error, mesh error and misses of the run; and says work, time, RAM and certificate beside. Time is
/// work at the speed that the build's record states, else at the nominal one. The same inputs give the same verdict.
[[nodiscard]] Verdict verdict_of(const ModelFile& model, const std::optional<BuildRecord>& build,
                                 const std::optional<TraceSummary>& run);

}  // namespace greenloop::offline
