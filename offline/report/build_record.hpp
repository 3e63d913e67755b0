#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace greenloop::offline {

struct StageTime {
  std::string name;
  double seconds = 0;
};

/// A named figure as text, unit included.
struct Fact {
  std::string name;
  std::string value;
};

/// One compression of the same Green's functions; what the record does not say is empty.
struct ErrorPoint {
  double epsilon = 0;
  double rms_error = 0;
  std::optional<double> worst_column_error;
  std::optional<double> kept_blocks;
  std::optional<double> bytes;
  std::optional<double> sum_work;  ///< units
};

/// What `greenloop build` recorded about itself. Every part may be missing.
struct BuildRecord {
  std::string scene;
  std::vector<StageTime> stages;
  std::vector<Fact> remesh;
  std::vector<Fact> solve;
  std::optional<double> epsilon;  ///< the chosen one
  std::vector<ErrorPoint> curve;  ///< by increasing epsilon
};

/// Reads the JSON file. Throws std::runtime_error naming file and key if it is no JSON or a present part has the wrong
/// type; points without epsilon or with an RMS error that is not positive are left out of the curve.
[[nodiscard]] BuildRecord load_build_record(const std::filesystem::path& path);

/// Every scalar of a JSON text as a fact, nested keys joined by " / "; empty if the text is no JSON object.
[[nodiscard]] std::vector<Fact> facts_of_json(const std::string& text);

}  // namespace greenloop::offline
