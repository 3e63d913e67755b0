#include "offline/report/build_record.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "formats/output/json_text.hpp"
#include "formats/write/nested_json.hpp"
#include "offline/report/axis.hpp"

namespace greenloop::offline {
namespace {

using nlohmann::json;

struct KnownSuffix {
  std::string_view suffix;
  std::string_view unit;
  double factor;
};

/// Keys carry their unit as a suffix; what is relative reads as a percentage.
constexpr std::array<KnownSuffix, 7> known_suffixes{{{"_degrees", "°", 1},
                                                     {"_relative", "%", 100},
                                                     {"_seconds", "s", 1},
                                                     {"_bytes", "B", 1},
                                                     {"_metres", "m", 1},
                                                     {"_pa", "Pa", 1},
                                                     {"seconds", "s", 1}}};

std::string words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string scalar_text(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_unsigned()) return readable_count(value.get<unsigned long long>());
  if (value.is_number()) return readable(value.get<double>());
  if (!value.is_array()) return json_text(value, -1);
  std::string list;
  for (const json& element : value) list += (list.empty() ? "" : ", ") + scalar_text(element);
  return list.empty() ? "none" : list;
}

Fact fact(const std::string& prefix, const std::string& key, const json& value) {
  for (const auto& [suffix, unit, factor] : known_suffixes) {
    if (!value.is_number() || !key.ends_with(suffix)) continue;
    const std::string name = key == suffix ? key : key.substr(0, key.size() - suffix.size());
    return {prefix + words(name), readable(factor * value.get<double>()) + "\u202f" + std::string(unit)};
  }
  return {prefix + words(key), scalar_text(value)};
}

void append_facts(const json& object, const std::string& prefix, std::vector<Fact>& facts) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      append_facts(value, prefix + words(key) + " / ", facts);
    } else {
      facts.push_back(fact(prefix, key, value));
    }
  }
}

std::vector<FactGroup> fact_groups(const json& object, const std::string& title) {
  std::vector<FactGroup> groups{{title, {}}};
  for (const auto& [key, value] : object.items()) {
    if (!value.is_object()) {
      groups.front().facts.push_back(fact("", key, value));
      continue;
    }
    groups.push_back({words(key), {}});
    append_facts(value, "", groups.back().facts);
  }
  std::erase_if(groups, [](const FactGroup& group) { return group.facts.empty(); });
  return groups;
}

/// Larger numbers, and smaller ones than its inverse, have no meaning in a record.
constexpr double most_number = 1e18;

constexpr std::size_t most_bytes = std::size_t{1} << 26;

/// Reads parts of the record and names the key that is wrong.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] const json* part(const json& object, const std::string& key, json::value_t type,
                                 const char* expected) const {
    const auto at = object.find(key);
    if (at == object.end() || at->is_null()) return nullptr;
    const bool numbers = type == json::value_t::number_float && at->is_number();
    if (!numbers && at->type() != type) {
      throw std::runtime_error(file_ + ": '" + key + "' is " + at->type_name() + ", expected " + expected);
    }
    return &*at;
  }
  [[nodiscard]] const json* object(const json& in, const std::string& key) const {
    return part(in, key, json::value_t::object, "an object");
  }
  [[nodiscard]] const json* array(const json& in, const std::string& key) const {
    return part(in, key, json::value_t::array, "an array");
  }
  [[nodiscard]] std::optional<double> number(const json& in, const std::string& key) const {
    const json* value = part(in, key, json::value_t::number_float, "a number");
    return value != nullptr ? std::optional(value->get<double>()) : std::nullopt;
  }
  /// None if it cannot be a count.
  [[nodiscard]] std::optional<unsigned long long> count(const json& in, const std::string& key) const {
    const auto value = number(in, key);
    return value && *value >= 0 && *value <= most_number ? std::optional(static_cast<unsigned long long>(*value))
                                                         : std::nullopt;
  }
  [[nodiscard]] std::string text(const json& in, const std::string& key) const {
    const json* value = part(in, key, json::value_t::string, "a text");
    return value != nullptr ? value->get<std::string>() : std::string();
  }
  void check_object(const json& value, const std::string& key) const {
    if (value.is_object()) return;
    throw std::runtime_error(file_ + ": an element of '" + key + "' is " + value.type_name() + ", expected an object");
  }

 private:
  std::string file_;
};

void read_stages(const Reader& reader, const json& root, BuildRecord& record) {
  const json* stages = reader.array(root, "stages");
  if (stages == nullptr) return;
  for (const json& stage : *stages) {
    reader.check_object(stage, "stages");
    const auto seconds = reader.number(stage, "seconds");
    if (seconds) record.stages.push_back({reader.text(stage, "name"), *seconds});
  }
}

/// A number that can stand on a logarithmic axis. The build writes 1e9 for the forces of an indefinite compliance.
std::optional<double> positive(const Reader& reader, const json& point, const std::string& key) {
  constexpr double no_answer = 1e9;
  const auto value = reader.number(point, key);
  return value && *value >= 1 / most_number && *value <= most_number &&
                 (key != "worst_patch_force_error" || *value < no_answer)
             ? value
             : std::nullopt;
}

std::vector<LevelFrontierPoint> level_points(const Reader& reader, const json& point) {
  std::vector<LevelFrontierPoint> levels;
  const json* array = reader.array(point, "levels");
  if (array == nullptr) return levels;
  for (const json& level : *array) {
    reader.check_object(level, "levels");
    const auto number = reader.number(level, "level");
    if (!number || *number < 0 || *number > 31) continue;
    levels.push_back({.level = static_cast<unsigned>(*number),
                      .rms_error = positive(reader, level, "rms_error"),
                      .worst_column_error = positive(reader, level, "worst_column_error"),
                      .worst_patch_force_error = positive(reader, level, "worst_patch_force_error"),
                      .bytes = positive(reader, level, "bytes"),
                      .step_work = positive(reader, level, "step_work")});
  }
  return levels;
}

std::optional<FrontierPoint> frontier_point(const Reader& reader, const json& point) {
  const auto threshold = reader.number(point, "threshold");
  if (!threshold) return std::nullopt;
  return FrontierPoint{.threshold = *threshold,
                       .rms_error = positive(reader, point, "rms_error"),
                       .worst_column_error = positive(reader, point, "worst_column_error"),
                       .worst_patch_force_error = positive(reader, point, "worst_patch_force_error"),
                       .kept_blocks = positive(reader, point, "kept_blocks"),
                       .bytes = positive(reader, point, "bytes"),
                       .step_work = positive(reader, point, "step_work"),
                       .levels = level_points(reader, point)};
}

void keep_one_per_threshold(std::vector<FrontierPoint>& frontier) {
  const auto before = [](const FrontierPoint& a, const FrontierPoint& b) {
    if (a.threshold != b.threshold) return a.threshold < b.threshold;
    return a.worst_patch_force_error.value_or(0) > b.worst_patch_force_error.value_or(0);
  };
  std::stable_sort(frontier.begin(), frontier.end(), before);
  const auto same = [](const FrontierPoint& a, const FrontierPoint& b) { return a.threshold == b.threshold; };
  frontier.erase(std::unique(frontier.begin(), frontier.end(), same), frontier.end());
}

/// "1.2 MB, 31,000 blocks, 800,000 units"; what the record does not say is left out.
std::string wavelet_cost(const Reader& reader, const json& wavelet) {
  const auto bytes = positive(reader, wavelet, "bytes");
  if (!bytes) return "cannot meet the errors asked for";
  std::string text = readable_bytes(*bytes);
  for (const auto& [key, unit] : {std::pair("kept_blocks", " blocks"), {"step_work", " units per step"}}) {
    const auto count = positive(reader, wavelet, key);
    if (count) text += ", " + readable_count(static_cast<unsigned long long>(*count)) + unit;
  }
  return text;
}

void read_wavelets(const Reader& reader, const json& compression, BuildRecord& record) {
  const json* wavelets = reader.array(compression, "wavelets");
  if (wavelets == nullptr || wavelets->empty()) return;
  FactGroup group{"Wavelets compared", {}};
  for (const json& wavelet : *wavelets) {
    reader.check_object(wavelet, "wavelets");
    const auto nodes = positive(reader, wavelet, "nodes");
    const std::string on = nodes ? " on " + readable_count(static_cast<unsigned long long>(*nodes)) + " nodes" : "";
    group.facts.push_back({reader.text(wavelet, "wavelet") + on, wavelet_cost(reader, wavelet)});
  }
  merge_facts(record.groups, {group});
}

void read_compression(const Reader& reader, const json& root, BuildRecord& record) {
  const json* compression = reader.object(root, "compression");
  if (compression == nullptr) return;
  record.threshold = reader.number(*compression, "threshold");
  record.patches = reader.count(*compression, "patches");
  const auto contacts = reader.count(*compression, "frontier_contacts");
  if (contacts && *contacts >= 1) record.contacts = contacts;
  if (const json* frontier = reader.array(*compression, "frontier")) {
    for (const json& point : *frontier) {
      reader.check_object(point, "frontier");
      if (const auto read = frontier_point(reader, point)) record.frontier.push_back(*read);
    }
  }
  keep_one_per_threshold(record.frontier);
  read_wavelets(reader, *compression, record);
}

}  // namespace

BuildRecord load_build_record(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be read; does it exist?");
  json root;
  try {
    std::string text;
    for (char letter = 0; text.size() <= most_bytes && stream.get(letter);) text.push_back(letter);
    if (text.size() > most_bytes) throw std::runtime_error(path.string() + ": is longer than any record, 64 MB");
    require_shallow(text, path.string());
    root = json::parse(text);
  } catch (const json::exception& error) {
    throw std::runtime_error(path.string() + ": no JSON: " + error.what());
  }
  if (!root.is_object()) throw std::runtime_error(path.string() + ": is " + root.type_name() + ", expected an object");
  const Reader reader(path.string());
  BuildRecord record;
  record.scene = reader.text(root, "scene");
  record.request = reader.text(root, "request");
  record.model_bytes = reader.count(root, "bytes");
  record.units_per_us = positive(reader, root, "units_per_us");
  read_stages(reader, root, record);
  for (const char* part : {"surface", "remesh", "volume", "solve"}) {
    if (const json* object = reader.object(root, part)) merge_facts(record.groups, fact_groups({{part, *object}}, ""));
  }
  read_compression(reader, root, record);
  return record;
}

std::string text_in_json(const std::string& text, const std::string& key) {
  if (!is_shallow(text)) return {};
  const json root = json::parse(text, nullptr, false);
  const auto at = root.is_object() ? root.find(key) : root.end();
  return root.is_object() && at != root.end() && at->is_string() ? at->get<std::string>() : std::string();
}

std::vector<FactGroup> facts_of_json(const std::string& text, const std::string& title) {
  if (!is_shallow(text)) return {};
  const json root = json::parse(text, nullptr, false);
  return root.is_object() ? fact_groups(root, title) : std::vector<FactGroup>{};
}

void merge_facts(std::vector<FactGroup>& groups, const std::vector<FactGroup>& more) {
  std::map<std::string, std::size_t> place;
  for (std::size_t k = 0; k < groups.size(); ++k) place.emplace(groups[k].title, k);
  for (const FactGroup& group : more) {
    const auto [at, is_new] = place.emplace(group.title, groups.size());
    if (is_new) {
      groups.push_back(group);
      continue;
    }
    std::vector<Fact>& facts = groups[at->second].facts;
    std::set<std::string> known;
    for (const Fact& fact : facts) known.insert(fact.name);
    for (const Fact& fact : group.facts) {
      if (known.insert(fact.name).second) facts.push_back(fact);
    }
  }
}

}  // namespace greenloop::offline
