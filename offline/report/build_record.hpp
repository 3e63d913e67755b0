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

/// One compression on one constraint level; empty as in FrontierPoint.
struct LevelFrontierPoint {
  unsigned level = 0;
  std::optional<double> rms_error;
  std::optional<double> worst_column_error;
  std::optional<double> worst_patch_force_error;
  std::optional<double> bytes;      ///< of the model cut off after the level
  std::optional<double> step_work;  ///< units, of a step resolved at the level
};

/// One compression of the same Green's functions that the build tried; what the record does not say, or what is no
/// positive number, is empty.
struct FrontierPoint {
  double threshold = 0;
  std::optional<double> rms_error;
  std::optional<double> worst_column_error;
  std::optional<double> worst_patch_force_error;
  std::optional<double> kept_blocks;
  std::optional<double> bytes;
  std::optional<double> step_work;  ///< units
  std::vector<LevelFrontierPoint> levels;
};

/// What `greenloop build` recorded about itself. Every part may be missing.
struct BuildRecord {
  std::string scene;
  std::string request;                              ///< of the model; empty in records of earlier versions
  std::optional<unsigned long long> model_bytes{};  ///< of the whole model file
  std::optional<double> units_per_us{};             ///< the speed that the scene states, or the nominal one
  std::vector<StageTime> stages;
  std::vector<FactGroup> groups;    ///< of every other object, "remesh", "solve", ..., and of wavelets compared
  std::optional<double> threshold;  ///< the chosen one
  std::optional<unsigned long long> patches;   ///< that the chosen one's forces were measured on
  std::optional<unsigned long long> contacts;  ///< that step_work is for
  std::vector<FrontierPoint> frontier;         ///< by increasing threshold, one point each
};

/// Reads the JSON file. Throws std::runtime_error naming file and key if it is no JSON or a present part has the wrong
/// type. Points without threshold are left out; of several with one threshold the one whose patch forces are worse is
/// kept, since it was measured on more patches.
[[nodiscard]] BuildRecord load_build_record(const std::filesystem::path& path);

/// The facts of a JSON text: its scalars under `title`, then one group per object in it, with the object's key as
/// title. Empty if the text is no JSON object.
[[nodiscard]] std::vector<FactGroup> facts_of_json(const std::string& text, const std::string& title);

/// What a JSON object says in text under `key`; empty if it is none or does not.
[[nodiscard]] std::string text_in_json(const std::string& text, const std::string& key);

/// Adds to `groups` what `more` has under titles or names that are not there yet.
void merge_facts(std::vector<FactGroup>& groups, const std::vector<FactGroup>& more);

}  // namespace greenloop::offline
