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

/// Facts under one heading.
struct FactGroup {
  std::string title;
  std::vector<Fact> facts;
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
  std::vector<FactGroup> groups;                    ///< of every other object in the record: "remesh", "solve", ...
  std::optional<double> epsilon;                    ///< the chosen one
  std::optional<unsigned long long> curve_columns;  ///< the curve is measured on so many columns
  std::vector<ErrorPoint> curve;                    ///< by increasing epsilon, with the chosen one where it is recorded
};

/// Reads the JSON file. Throws std::runtime_error naming file and key if it is no JSON or a present part has the wrong
/// type; points without epsilon or with an RMS error that is not positive are left out of the curve.
[[nodiscard]] BuildRecord load_build_record(const std::filesystem::path& path);

/// The facts of a JSON text: its scalars under `title`, then one group per object in it, with the object's key as
/// title. Empty if the text is no JSON object.
[[nodiscard]] std::vector<FactGroup> facts_of_json(const std::string& text, const std::string& title);

/// Adds to `groups` what `more` has under titles or names that are not there yet.
void merge_facts(std::vector<FactGroup>& groups, const std::vector<FactGroup>& more);

}  // namespace greenloop::offline
